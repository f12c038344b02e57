#ifndef PLANEFOLD_CALIBRATE_MARKERS_H
#define PLANEFOLD_CALIBRATE_MARKERS_H

#include <array>
#include <opencv2/core.hpp>
#include <vector>

#include "board.h"

namespace pf::calibrate {

/// Whether this build knows markers: OpenCV's aruco module was there.
bool have_markers();

/// "DICT_4X4_50" and so on: the smallest that has enough of them.
const char* dictionary_name(const Board& board);

struct Marker {
  int number = 0;
  std::array<cv::Point2f, 4> corners;  ///< clockwise from the one that is printed top left [px]
};

/// The markers of the board's dictionary in a picture of grey levels, also those of higher numbers than the board has.
std::vector<Marker> find_markers(const cv::Mat& grey, const Board& board);

/// One marker as it is printed: modules row by row, with its border; nonzero is white. Square.
cv::Mat marker_modules(const Board& board, int number);

/// The white square that a marker is printed in, and the other way round; -1 for what is none.
cv::Point square_of_marker(const Board& board, int number);
int marker_in_square(const Board& board, int column, int row);

}  // namespace pf::calibrate

#endif
