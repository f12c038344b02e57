#include "board.h"

#include <cstdio>

namespace pf::calibrate {

cv::Point3f Board::point(int corner) const {
  const int across = columns - 1;
  return {static_cast<float>((corner % across) * square_m), static_cast<float>((corner / across) * square_m), 0.0F};
}

const char* target_name(Target target) { return target == Target::kCharuco ? "charuco" : "chessboard"; }

bool parse_board(const std::string& text, Board& board, std::string& error) {
  Board read = board;
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
  if (read.target == Target::kCharuco && read.markers() > kMostMarkers) {
    error = "board '" + text + "': it has " + std::to_string(read.markers()) + " markers, and there are " +
            std::to_string(kMostMarkers) + " different ones; take fewer squares or --target chessboard";
    return false;
  }
  board = read;
  return true;
}

std::string board_text(const Board& board) {
  char text[80];
  std::snprintf(text, sizeof(text), "%dx%d:%g", board.columns, board.rows, board.square_m);
  return text;
}

}  // namespace pf::calibrate
