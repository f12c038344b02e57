#include "views.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

namespace pf::calibrate {

namespace {

double distance(const cv::Point2f& a, const cv::Point2f& b) { return std::hypot(a.x - b.x, a.y - b.y); }

int cell_of(const cv::Point2f& corner, cv::Size image) {
  const int x = std::clamp(static_cast<int>(corner.x * kCellsAcross / image.width), 0, kCellsAcross - 1);
  const int y = std::clamp(static_cast<int>(corner.y * kCellsDown / image.height), 0, kCellsDown - 1);
  return y * kCellsAcross + x;
}

std::vector<View> sharp_ones(const std::vector<View>& views) {
  std::vector<double> blurs;
  for (const View& view : views) {
    blurs.push_back(view.blur_px);
  }
  const auto quartile = blurs.begin() + static_cast<std::ptrdiff_t>(blurs.size() / 4);
  std::nth_element(blurs.begin(), quartile, blurs.end());
  const double most = 1.5 * *quartile + 0.5;
  std::vector<View> sharp;
  std::copy_if(views.begin(), views.end(), std::back_inserter(sharp), [&](const View& v) { return v.blur_px <= most; });
  return sharp;
}

double level_at(const cv::Mat& grey, const cv::Point2f& p) {
  const int x = std::clamp(static_cast<int>(p.x), 0, grey.cols - 2);
  const int y = std::clamp(static_cast<int>(p.y), 0, grey.rows - 2);
  const double u = std::clamp(p.x - static_cast<float>(x), 0.0F, 1.0F);
  const double v = std::clamp(p.y - static_cast<float>(y), 0.0F, 1.0F);
  const uchar *a = grey.ptr(y) + x, *b = grey.ptr(y + 1) + x;
  return (1 - v) * ((1 - u) * a[0] + u * a[1]) + v * ((1 - u) * b[0] + u * b[1]);
}

/// Over how many pixels an edge between two squares rises: the step over the steepest slope, the median over all edges
/// between neighbours of a row, each read half a square to either side.
double edge_spread(const cv::Mat& grey, const std::vector<cv::Point2f>& corners, size_t across) {
  std::vector<double> spreads;
  for (size_t i = 0; i + across < corners.size(); ++i) {
    if ((i + 1) % across == 0) {
      continue;
    }
    const cv::Point2f middle = 0.5F * (corners[i] + corners[i + 1]);
    const cv::Point2f down = corners[i + across] - corners[i];
    const double length = std::hypot(down.x, down.y);
    const cv::Point2f step = down * static_cast<float>(0.5 / length);  // half a pixel
    const int half = std::max(4, static_cast<int>(length));            // in such steps: half a square
    double steepest = 0.0;
    for (int k = -half; k + 2 <= half; ++k) {
      const double rise = level_at(grey, middle + static_cast<float>(k + 2) * step) -
                          level_at(grey, middle + static_cast<float>(k) * step);
      steepest = std::max(steepest, std::fabs(rise));
    }
    const double contrast = std::fabs(level_at(grey, middle + static_cast<float>(half) * step) -
                                      level_at(grey, middle - static_cast<float>(half) * step));
    spreads.push_back(contrast / std::max(steepest, 1.0));
  }
  const auto median = spreads.begin() + static_cast<std::ptrdiff_t>(spreads.size() / 2);
  std::nth_element(spreads.begin(), median, spreads.end());
  return *median;
}

}  // namespace

bool find_board(const cv::Mat& grey, const Board& board, View& view) {
  // A small copy says quickly that there is no board; most frames of a film without one end here.
  const double scale = std::min(1.0, 640.0 / grey.cols);
  cv::Mat small;
  cv::resize(grey, small, {}, scale, scale, cv::INTER_AREA);
  std::vector<cv::Point2f> rough;
  const int quick = cv::CALIB_CB_NORMALIZE_IMAGE;
  if (!cv::findChessboardCornersSB(small, board.corners(), rough, quick) &&
      !cv::findChessboardCornersSB(small, board.corners(), rough, quick | cv::CALIB_CB_EXHAUSTIVE)) {
    return false;
  }
  view.corners.clear();
  for (const cv::Point2f& p : rough) {  // centres of pixels keep their place in the picture
    view.corners.emplace_back(static_cast<float>((p.x + 0.5) / scale - 0.5),
                              static_cast<float>((p.y + 0.5) / scale - 0.5));
  }
  // The window of the refinement holds one corner and no other.
  double nearest = std::numeric_limits<double>::infinity();
  const int across = board.corners().width;
  for (size_t i = 0; i < view.corners.size(); ++i) {
    if ((i + 1) % static_cast<size_t>(across) != 0) {
      nearest = std::min(nearest, distance(view.corners[i], view.corners[i + 1]));
    }
    if (i + static_cast<size_t>(across) < view.corners.size()) {
      nearest = std::min(nearest, distance(view.corners[i], view.corners[i + static_cast<size_t>(across)]));
    }
  }
  const int half = std::clamp(static_cast<int>(0.35 * nearest), 2, 12);
  const cv::TermCriteria until(cv::TermCriteria::EPS | cv::TermCriteria::COUNT, 60, 1e-4);
  cv::cornerSubPix(grey, view.corners, {half, half}, {-1, -1}, until);
  view.blur_px = edge_spread(grey, view.corners, static_cast<size_t>(across));
  return true;
}

std::array<double, 6> describe(const View& view, const Board& board, cv::Size image) {
  const auto across = static_cast<size_t>(board.corners().width);
  const cv::Point2f& a = view.corners.front();
  const cv::Point2f& b = view.corners[across - 1];
  const cv::Point2f& c = view.corners.back();
  const cv::Point2f& d = view.corners[view.corners.size() - across];
  const double top = distance(a, b), right = distance(b, c), bottom = distance(c, d), left = distance(d, a);
  return {static_cast<double>(a.x + b.x + c.x + d.x) / (4.0 * image.width),
          static_cast<double>(a.y + b.y + c.y + d.y) / (4.0 * image.height),
          0.5 * std::log((top + bottom) * (left + right) / (4.0 * image.area())),
          2.0 * std::log(left / right),
          2.0 * std::log(top / bottom),
          std::log((top + bottom) / (left + right))};
}

std::array<int, kCellsAcross * kCellsDown> count_corners(const std::vector<View>& views, cv::Size image) {
  std::array<int, kCellsAcross * kCellsDown> counts{};
  for (const View& view : views) {
    for (const cv::Point2f& corner : view.corners) {
      ++counts[static_cast<size_t>(cell_of(corner, image))];
    }
  }
  return counts;
}

double covered_share(const std::vector<View>& views, cv::Size image) {
  const auto counts = count_corners(views, image);
  const auto covered = std::count_if(counts.begin(), counts.end(), [](int count) { return count > 0; });
  return static_cast<double>(covered) / static_cast<double>(counts.size());
}

std::vector<View> choose_views(const std::vector<View>& all, const Board& board, cv::Size image, int most) {
  if (all.empty()) {
    return {};
  }
  // One after the other the view that differs most from those taken, and that reaches new parts of the picture.
  constexpr double kSame = 0.04, kNewCells = 1.0;
  const std::vector<View> views = sharp_ones(all);
  std::vector<double> nearest(views.size(), 1.0);
  std::vector<bool> taken(views.size(), false);
  std::vector<View> chosen;
  while (static_cast<int>(chosen.size()) < most) {
    const auto counts = count_corners(chosen, image);
    double best = -1.0;
    size_t which = views.size();
    for (size_t i = 0; i < views.size(); ++i) {
      if (taken[i] || nearest[i] < kSame) {
        continue;
      }
      std::array<bool, kCellsAcross * kCellsDown> fresh{};
      for (const cv::Point2f& corner : views[i].corners) {
        const auto cell = static_cast<size_t>(cell_of(corner, image));
        fresh[cell] = counts[cell] == 0;
      }
      const auto gain = static_cast<double>(std::count(fresh.begin(), fresh.end(), true)) / fresh.size();
      const double score = nearest[i] + kNewCells * gain;
      if (score > best) {
        best = score;
        which = i;
      }
    }
    if (which == views.size()) {
      break;
    }
    taken[which] = true;
    chosen.push_back(views[which]);
    const auto new_one = describe(views[which], board, image);
    for (size_t i = 0; i < views.size(); ++i) {
      const auto other = describe(views[i], board, image);
      double squares = 0.0;
      for (size_t k = 0; k < other.size(); ++k) {
        squares += (other[k] - new_one[k]) * (other[k] - new_one[k]);
      }
      nearest[i] = std::min(nearest[i], std::sqrt(squares));
    }
  }
  std::sort(chosen.begin(), chosen.end(), [](const View& a, const View& b) { return a.frame < b.frame; });
  return chosen;
}

}  // namespace pf::calibrate
