// The peer of a whole frame: OpenCV's pyramidal Lucas-Kanade on 100 points. A module of its own, because OpenCV brings an OpenBLAS
// that must not be loaded before the covariance suite has chosen its core type.
#include <algorithm>
#include <cstdint>
#include <exception>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video.hpp>
#include <vector>

#include "../thread_time.h"

namespace {

constexpr int kPoints = 100;
constexpr double kQuality = 0.01;   // goodFeaturesToTrack: share of the best corner's score
constexpr double kDistance = 10.0;  // goodFeaturesToTrack: [px]

}  // namespace

extern "C" {

/// "OpenCV 4.6.0"-like name of what is measured.
const char* pf_bench_flow_name() { return "OpenCV " CV_VERSION " calcOpticalFlowPyrLK"; }

/// Microseconds of one plain call from previous to next (window 21x21, maxLevel 3, pyramids inside); corners are found before, untimed.
/// Negative: OpenCV refused. points, tracked: how many went in and came out.
double pf_bench_flow_us(const uint8_t* previous, const uint8_t* next, int width, int height, int* points,
                        int* tracked) {
  try {
    cv::setNumThreads(1);
    const cv::Mat from(height, width, CV_8U, const_cast<uint8_t*>(previous));
    const cv::Mat to(height, width, CV_8U, const_cast<uint8_t*>(next));
    std::vector<cv::Point2f> corners, moved;
    cv::goodFeaturesToTrack(from, corners, kPoints, kQuality, kDistance);
    *points = static_cast<int>(corners.size());
    *tracked = 0;
    if (corners.empty()) return -1;
    std::vector<uint8_t> status;
    std::vector<float> error;
    const double begin = thread_us();
    cv::calcOpticalFlowPyrLK(from, to, corners, moved, status, error);
    const double us = thread_us() - begin;
    *tracked = static_cast<int>(std::count(status.begin(), status.end(), 1));
    return us;
  } catch (const std::exception&) {
    return -1;
  }
}

}  // extern "C"
