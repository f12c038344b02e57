#include "levels.h"

#include <algorithm>
#include <cmath>

namespace pf::calibrate {

double level_at(const cv::Mat& grey, const cv::Point2f& p) {
  const int x = std::clamp(static_cast<int>(p.x), 0, grey.cols - 2);
  const int y = std::clamp(static_cast<int>(p.y), 0, grey.rows - 2);
  const double u = std::clamp(p.x - static_cast<float>(x), 0.0F, 1.0F);
  const double v = std::clamp(p.y - static_cast<float>(y), 0.0F, 1.0F);
  const uchar *a = grey.ptr(y) + x, *b = grey.ptr(y + 1) + x;
  return (1 - v) * ((1 - u) * a[0] + u * a[1]) + v * ((1 - u) * b[0] + u * b[1]);
}

double edge_spread(const cv::Mat& grey, const Board& board, const View& view) {
  const int across = board.columns - 1;
  std::vector<const cv::Point2f*> at(static_cast<size_t>(across * (board.rows - 1)), nullptr);
  for (size_t i = 0; i < view.corners.size(); ++i) {
    at[static_cast<size_t>(view.numbers[i])] = &view.corners[i];
  }
  // Half a square to either side; where a marker follows, to near its border.
  const double light = board.target == Target::kCharuco ? 0.8 * (1.0 - kMarkerShare) : 1.0;
  std::vector<double> spreads;
  for (size_t i = 0; i + static_cast<size_t>(across) < at.size(); ++i) {
    const size_t below = i + static_cast<size_t>(across);
    if ((i + 1) % static_cast<size_t>(across) == 0 || at[i] == nullptr || at[i + 1] == nullptr ||
        at[below] == nullptr) {
      continue;
    }
    const cv::Point2f middle = 0.5F * (*at[i] + *at[i + 1]);
    const cv::Point2f down = *at[below] - *at[i];
    const double length = std::hypot(down.x, down.y);
    const cv::Point2f step = down * static_cast<float>(0.5 / length);  // half a pixel
    const int column = static_cast<int>(i) % across + 1, row = static_cast<int>(i) / across + 1;
    const bool dark_below = board.is_dark(column, row);
    const auto reach = [&](bool dark) { return std::max(4, static_cast<int>((dark ? 1.0 : light) * length)); };
    const int first = -reach(!dark_below), last = reach(dark_below);  // in such steps
    double steepest = 0.0;
    for (int k = first; k + 2 <= last; ++k) {
      const double rise = level_at(grey, middle + static_cast<float>(k + 2) * step) -
                          level_at(grey, middle + static_cast<float>(k) * step);
      steepest = std::max(steepest, std::fabs(rise));
    }
    const double contrast = std::fabs(level_at(grey, middle + static_cast<float>(last) * step) -
                                      level_at(grey, middle + static_cast<float>(first) * step));
    spreads.push_back(contrast / std::max(steepest, 1.0));
  }
  if (spreads.empty()) {
    return 0.0;
  }
  const auto median = spreads.begin() + static_cast<std::ptrdiff_t>(spreads.size() / 2);
  std::nth_element(spreads.begin(), median, spreads.end());
  return *median;
}

}  // namespace pf::calibrate
