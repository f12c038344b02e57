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
  std::vector<int> numbers;          ///< which of the board's inner corners they are
  double blur_px = 0.0;              ///< how far an edge spreads
  bool light_first = false;          ///< the board is of that kind, whatever the command line says
};

/// A view of part of a board has at least so many corners.
constexpr size_t kFewestCorners = 10;

/// What was seen of a board where it does not make a view.
struct Sighting {
  int markers = 0, highest_marker = -1;
  int pairs = 0, agreeing_pairs = 0;  ///< markers that should be neighbours on the board, and those that are
};

/// The board's inner corners in a picture of grey levels: all of a chessboard's, or those of a ChArUco board that are
/// there. false where that is not enough for a view.
bool find_board(const cv::Mat& grey, const Board& board, View& view, Sighting& found);

/// How many squares a chessboard of any size in the picture has, the longer side first; 0 x 0 where there
/// is none.
cv::Size size_of_chessboard(const cv::Mat& grey);

/// Where and how the board is seen, in numbers of which each spans about one over all useful views: the centre of the
/// part that is seen, the logarithm of the squares' size, that part's foreshortening across and down, and the
/// squares' proportions.
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
