#ifndef PLANEFOLD_CALIBRATE_BOARD_H
#define PLANEFOLD_CALIBRATE_BOARD_H

#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace pf::calibrate {

/// A chessboard: squares as they are printed, of which the inner corners are what is measured.
struct Board {
  int columns = 10, rows = 7;  ///< squares
  double square_m = 0.025;

  cv::Size corners() const { return {columns - 1, rows - 1}; }
  double width_m() const { return columns * square_m; }
  double height_m() const { return rows * square_m; }
  /// Inner corners row by row, in the plane z = 0 [m].
  std::vector<cv::Point3f> points() const;
};

/// "COLUMNSxROWS:SQUARE_METRES", for example 10x7:0.025. false: error is one line.
bool parse_board(const std::string& text, Board& board, std::string& error);

}  // namespace pf::calibrate

#endif
