// The peers of the patch aligner: OpenCV's ECC, and its pyramidal Lucas-Kanade against the template warped to where the patch was last. A
// module of its own, as flow.cpp.
#include <algorithm>
#include <cstdint>
#include <exception>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video.hpp>
#include <vector>

#include "../thread_time.h"

namespace {

constexpr int kMargin = 24;  // around the patch where it was last [px]
constexpr int kEccIterations = 30;
constexpr double kEccEpsilon = 1e-4;
constexpr int kPoints = 100;
constexpr double kQuality = 0.01, kDistance = 5.0;  // goodFeaturesToTrack; [px]
constexpr int kMinPoints = 8;
constexpr double kRansacPx = 1.0;
constexpr int kFlowLevel = 1;    // coarsest: half of its window there is inside of the margin
constexpr int kFlowWindow = 21;  // [px]

cv::Matx33d matrix_of(const double* H) { return cv::Matx33d(H); }

/// Where the patch was last, with a margin.
cv::Rect surroundings(const cv::Matx33d& H, const cv::Rect& patch, const cv::Size& size) {
  std::vector<cv::Point2f> corners = {
      {static_cast<float>(patch.x), static_cast<float>(patch.y)},
      {static_cast<float>(patch.x + patch.width), static_cast<float>(patch.y)},
      {static_cast<float>(patch.x), static_cast<float>(patch.y + patch.height)},
      {static_cast<float>(patch.x + patch.width), static_cast<float>(patch.y + patch.height)}};
  cv::perspectiveTransform(corners, corners, H);
  const cv::Rect box = cv::boundingRect(corners);
  return cv::Rect(box.x - kMargin, box.y - kMargin, box.width + 2 * kMargin, box.height + 2 * kMargin) &
         cv::Rect(cv::Point(), size);
}

cv::Matx33d shifted(double x, double y) { return {1, 0, x, 0, 1, y, 0, 0, 1}; }

/// H of the patch's own pixels in the cut-out of the image.
bool ecc(const cv::Mat& reference, const cv::Rect& patch, const cv::Mat& image, cv::Matx33d* H) {
  const cv::Rect box = surroundings(*H, patch, image.size());
  cv::Mat warp(shifted(-box.x, -box.y) * *H * shifted(patch.x, patch.y));
  warp = warp / warp.at<double>(2, 2);
  warp.convertTo(warp, CV_32F);
  cv::findTransformECC(reference(patch), image(box), warp, cv::MOTION_HOMOGRAPHY,
                       {cv::TermCriteria::COUNT | cv::TermCriteria::EPS, kEccIterations, kEccEpsilon}, cv::noArray(),
                       5);
  cv::Matx33f found = warp;
  *H = shifted(box.x, box.y) * cv::Matx33d(found) * shifted(-patch.x, -patch.y);
  return true;
}

std::vector<cv::Point2f> points;  // of the patch of the sequence that is under way

void find_points(const cv::Mat& reference, const cv::Rect& patch) {
  cv::goodFeaturesToTrack(reference(patch), points, kPoints, kQuality, kDistance);
  for (cv::Point2f& p : points) p += cv::Point2f(patch.tl());
}

bool flow(const cv::Mat& reference, const cv::Rect& patch, const cv::Mat& image, cv::Matx33d* H) {
  const cv::Rect box = surroundings(*H, patch, image.size());
  if (box.empty()) return false;
  const cv::Rect around = (patch + cv::Size(2 * kMargin, 2 * kMargin) - cv::Point(kMargin, kMargin)) &
                          cv::Rect(cv::Point(), reference.size());
  cv::Mat warped;
  cv::warpPerspective(reference(around), warped, shifted(-box.x, -box.y) * *H * shifted(around.x, around.y),
                      box.size());
  if (points.size() < kMinPoints) return false;
  std::vector<cv::Point2f> from, to;
  std::vector<uint8_t> status;
  std::vector<float> error;
  cv::perspectiveTransform(points, from, shifted(-box.x, -box.y) * *H);
  cv::calcOpticalFlowPyrLK(warped, image(box), from, to, status, error, {kFlowWindow, kFlowWindow}, kFlowLevel);
  std::vector<cv::Point2f> a, b;
  for (size_t i = 0; i < from.size(); ++i)
    if (status[i] != 0) {
      a.push_back(points[i]);
      b.push_back(to[i] + cv::Point2f(box.tl()));
    }
  if (a.size() < kMinPoints) return false;

  cv::Mat inliers;
  const cv::Mat found = cv::findHomography(a, b, cv::RANSAC, kRansacPx, inliers);
  if (found.empty() || cv::countNonZero(inliers) < kMinPoints) return false;
  *H = cv::Matx33d(found);
  return true;
}

}  // namespace

extern "C" {

const char* pf_bench_homography_name() { return "OpenCV " CV_VERSION; }

/// Moves H (row by row, pixels of reference to pixels of image) from where the patch was last to where it is. method: 0 ECC, 1
/// Lucas-Kanade. Microseconds, or negative where the patch is lost. Both images are width x height; first is 1 in the first call of
/// a sequence.
double pf_bench_homography(int method, const uint8_t* reference, int left, int top, int side, const uint8_t* image,
                           int width, int height, int first, double* H) {
  try {
    cv::setNumThreads(1);
    const cv::Mat from(height, width, CV_8U, const_cast<uint8_t*>(reference));
    const cv::Mat to(height, width, CV_8U, const_cast<uint8_t*>(image));
    const cv::Rect patch(left, top, side, side);
    cv::Matx33d now = matrix_of(H);
    if (first != 0) find_points(from, patch);
    const double begin = thread_us();
    const bool found = method == 0 ? ecc(from, patch, to, &now) : flow(from, patch, to, &now);
    const double us = thread_us() - begin;
    if (!found) return -us;
    std::copy(now.val, now.val + 9, H);
    return us;
  } catch (const std::exception&) {
    return -1;
  }
}

}  // extern "C"
