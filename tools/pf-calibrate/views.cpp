#include "views.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "charuco.h"
#include "levels.h"

namespace pf::calibrate {

namespace {

constexpr double kMostBend = 0.25;  // RMS change of a square's side to the next one's, in sides

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

/// Whether a grid of corners (row by row, so many across) changes from one to the next as little as that of most views of a board.
/// Other things with many corners, such as tags, give grids that jump: 0.42 to 1.1, where a board has less unless it is very slanted.
bool is_regular(const std::vector<cv::Point2f>& corners, int across) {
  const int count = static_cast<int>(corners.size());
  double squares = 0.0;
  int triples = 0;
  const auto add = [&](int before, int at, int after) {
    const auto a = corners[static_cast<size_t>(before)], b = corners[static_cast<size_t>(at)],
               c = corners[static_cast<size_t>(after)];
    const double bend = 2.0 * distance(a + c, b + b) / std::max(1e-3, distance(a, c));
    squares += bend * bend;
    ++triples;
  };
  for (int i = 0; i < count; ++i) {
    if (i % across > 0 && i % across + 1 < across) add(i - 1, i, i + 1);
    if (i >= across && i + across < count) add(i - across, i, i + across);
  }
  return triples > 0 && std::sqrt(squares / triples) < kMostBend;
}

bool find_chessboard(const cv::Mat& grey, const Board& board, View& view) {
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
  view.numbers.clear();
  for (const cv::Point2f& p : rough) {  // centres of pixels keep their place in the picture
    view.numbers.push_back(static_cast<int>(view.corners.size()));
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
  view.blur_px = edge_spread(grey, board, view);
  return true;
}

}  // namespace

bool find_board(const cv::Mat& grey, const Board& board, View& view, Sighting& found) {
  return board.target == Target::kCharuco ? find_charuco(grey, board, view, found) : find_chessboard(grey, board, view);
}

cv::Size size_of_chessboard(const cv::Mat& grey) {
  cv::Mat small, meta;
  std::vector<cv::Point2f> corners;
  const double scale = std::min(1.0, 640.0 / grey.cols);
  cv::resize(grey, small, {}, scale, scale, cv::INTER_AREA);
  const int flags = cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_LARGER;
  if (!cv::findChessboardCornersSB(small, {3, 3}, corners, flags, meta) || !is_regular(corners, meta.cols)) {
    return {};
  }
  return {std::max(meta.cols, meta.rows) + 1, std::min(meta.cols, meta.rows) + 1};
}

std::array<double, 6> describe(const View& view, const Board& board, cv::Size image) {
  const int columns = board.columns - 1;
  std::vector<cv::Point2f> squares;
  float left = 1e9F, right = -1.0F, top = 1e9F, bottom = -1.0F;
  for (int number : view.numbers) {
    const auto x = static_cast<float>(number % columns), y = static_cast<float>(number / columns);
    squares.emplace_back(x, y);
    left = std::min(left, x), right = std::max(right, x);
    top = std::min(top, y), bottom = std::max(bottom, y);
  }
  std::vector<cv::Point2f> ends = {{left, top}, {right, top}, {right, bottom}, {left, bottom}}, seen;
  cv::perspectiveTransform(ends, seen, cv::findHomography(squares, view.corners));
  const double across = right - left, down = bottom - top;
  const double above = distance(seen[0], seen[1]) / across, below = distance(seen[2], seen[3]) / across;
  const double at_left = distance(seen[3], seen[0]) / down, at_right = distance(seen[1], seen[2]) / down;
  const double side = 0.25 * (above + below) * (at_left + at_right) * (columns - 1) * (board.rows - 2);
  return {static_cast<double>(seen[0].x + seen[1].x + seen[2].x + seen[3].x) / (4.0 * image.width),
          static_cast<double>(seen[0].y + seen[1].y + seen[2].y + seen[3].y) / (4.0 * image.height),
          0.5 * std::log(side / image.area()),
          2.0 * std::log(at_left / at_right),
          2.0 * std::log(above / below),
          std::log((above + below) / (at_left + at_right))};
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
  std::vector<std::array<double, 6>> described;
  for (const View& view : views) {
    described.push_back(describe(view, board, image));
  }
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
    for (size_t i = 0; i < views.size(); ++i) {
      double squares = 0.0;
      for (size_t k = 0; k < described[i].size(); ++k) {
        const double apart = described[i][k] - described[which][k];
        squares += apart * apart;
      }
      nearest[i] = std::min(nearest[i], std::sqrt(squares));
    }
  }
  std::sort(chosen.begin(), chosen.end(), [](const View& a, const View& b) { return a.frame < b.frame; });
  return chosen;
}

}  // namespace pf::calibrate
