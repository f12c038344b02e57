#include "board.h"

#include <cstdio>

namespace pf::calibrate {

std::vector<cv::Point3f> Board::points() const {
  std::vector<cv::Point3f> result;
  for (int y = 0; y < rows - 1; ++y) {
    for (int x = 0; x < columns - 1; ++x) {
      result.emplace_back(static_cast<float>(x * square_m), static_cast<float>(y * square_m), 0.0F);
    }
  }
  return result;
}

bool parse_board(const std::string& text, Board& board, std::string& error) {
  Board read;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%dx%d:%lf%c", &read.columns, &read.rows, &read.square_m, &rest) != 3) {
    error = "board '" + text + "': write COLUMNSxROWS:SQUARE_METRES, counted in squares, for example 10x7:0.025";
    return false;
  }
  if (read.columns < 4 || read.rows < 4 || read.columns > 60 || read.rows > 60) {
    error = "board '" + text + "': 4 to 60 squares are possible in each direction";
    return false;
  }
  if (!(read.square_m >= 0.001 && read.square_m <= 1.0)) {
    error = "board '" + text + "': a square of 0.001 m to 1 m is possible";
    return false;
  }
  board = read;
  return true;
}

}  // namespace pf::calibrate
