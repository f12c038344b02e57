#ifndef PLANEFOLD_CALIBRATE_BOARD_H
#define PLANEFOLD_CALIBRATE_BOARD_H

#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace pf::calibrate {

enum class Target { kChessboard, kCharuco };

/// A chessboard: squares as they are printed, of which the inner corners are what is measured. A ChArUco board has a
/// marker in every white square, which says which square it is, so that a part of the board is enough.
struct Board {
  Target target = Target::kChessboard;
  int columns = 10, rows = 7;  ///< squares
  double square_m = 0.025;
  bool light_first =
      false;  ///< the square at the top left is white, as in OpenCV's boards of before 4.6 with an even number of rows

  cv::Size corners() const { return {columns - 1, rows - 1}; }
  double width_m() const { return columns * square_m; }
  double height_m() const { return rows * square_m; }
  bool is_dark(int column, int row) const { return (column + row) % 2 == (light_first ? 1 : 0); }
  int markers() const { return columns * rows / 2; }
  /// An inner corner by its number, row by row: where it lies in the plane z = 0 [m].
  cv::Point3f point(int corner) const;
};

/// Of a white square, which share of its side the marker takes.
constexpr double kMarkerShare = 0.7;
constexpr int kMostMarkers = 1000;

const char* target_name(Target target);

/// "COLUMNSxROWS:SQUARE_METRES", for example 10x7:0.025. false: error is one line.
bool parse_board(const std::string& text, Board& board, std::string& error);

/// As parse_board reads it.
std::string board_text(const Board& board);

}  // namespace pf::calibrate

#endif
