// The peer of a search with a masked template: OpenCV's matchTemplate about the same predicted pixels. A module of its own, as flow.cpp.
#include <cstddef>
#include <cstdint>
#include <exception>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "../thread_time.h"

extern "C" {

/// "OpenCV 4.6.0"-like name of what is measured.
const char* pf_bench_match_name() { return "OpenCV " CV_VERSION " matchTemplate, TM_CCOEFF_NORMED"; }

/// Microseconds for `count` templates of side x side, one after the other: each at the whole pixels within `reach` of its centre (x, y).
/// masks: side x side weights of each, 0 .. 1; null: OpenCV's way without masks. found: best (x, y) of each. Negative: OpenCV refused.
double pf_bench_match_us(const uint8_t* image, int width, int height, const uint8_t* templates, const float* masks,
                         const int* centres, int count, int side, int reach, int* found) {
  try {
    cv::setNumThreads(1);
    const cv::Mat whole(height, width, CV_8U, const_cast<uint8_t*>(image));
    const int size = side + 2 * reach;
    std::vector<cv::Mat> pattern, mask;
    for (int k = 0; k < count; ++k) {
      const std::ptrdiff_t at = std::ptrdiff_t{k} * side * side;
      pattern.emplace_back(side, side, CV_8U, const_cast<uint8_t*>(templates + at));
      if (masks != nullptr) mask.emplace_back(side, side, CV_32F, const_cast<float*>(masks + at));
    }
    cv::Mat scores;
    const double begin = thread_us();
    for (int k = 0; k < count; ++k) {
      const int left = centres[2 * k] - size / 2, top = centres[2 * k + 1] - size / 2;
      const cv::Mat region = whole(cv::Rect(left, top, size, size));
      if (masks != nullptr)
        cv::matchTemplate(region, pattern[static_cast<size_t>(k)], scores, cv::TM_CCOEFF_NORMED,
                          mask[static_cast<size_t>(k)]);
      else
        cv::matchTemplate(region, pattern[static_cast<size_t>(k)], scores, cv::TM_CCOEFF_NORMED);
      cv::Point best;
      cv::minMaxLoc(scores, nullptr, nullptr, nullptr, &best);
      found[2 * k] = left + best.x + side / 2;
      found[2 * k + 1] = top + best.y + side / 2;
    }
    return thread_us() - begin;
  } catch (const std::exception&) {
    return -1;
  }
}

}  // extern "C"
