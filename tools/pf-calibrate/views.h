#ifndef PLANEFOLD_CALIBRATE_VIEWS_H
#define PLANEFOLD_CALIBRATE_VIEWS_H

#include <array>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "board.h"

namespace pf::calibrate {

/// The board as one frame shows it.
struct View {
  int64_t frame = 0;
  std::vector<cv::Point2f> corners;  ///< row by row [px]
  double blur_px = 0.0;              ///< how far an edge spreads
};

/// All of the board's inner corners in a picture of grey levels; false where they are not all there.
bool find_board(const cv::Mat& grey, const Board& board, View& view);

/// Where and how the board is seen, in numbers of which each spans about one over all useful views: its centre, the
/// logarithm of its size, its foreshortening across and down, and its proportions.
std::array<double, 6> describe(const View& view, const Board& board, cv::Size image);

/// Cells of the picture that hold a corner of one of the views.
constexpr int kCellsAcross = 10, kCellsDown = 8;
std::array<int, kCellsAcross * kCellsDown> count_corners(const std::vector<View>& views, cv::Size image);
double covered_share(const std::vector<View>& views, cv::Size image);

/// The most different of the sharp views, at most `most` of them, by their order in time. Views that blur spreads
/// much more than most are left out first.
std::vector<View> choose_views(const std::vector<View>& views, const Board& board, cv::Size image, int most);

}  // namespace pf::calibrate

#endif
