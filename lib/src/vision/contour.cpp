#include "vision/contour.h"

#include <cstring>

namespace pf {

ContourWalk::ContourWalk(const ImageView& image, int level, const ContourBuffers& buffers)
    : image_(image), level_(level), buffers_(buffers) {
  std::memset(buffers_.marks, 0, contour_mark_bytes(image.width, image.height));
}

bool ContourWalk::is_marked(int x, int y) const {
  const std::size_t i =
      static_cast<std::size_t>(y) * static_cast<std::size_t>(image_.width) + static_cast<std::size_t>(x);
  return (buffers_.marks[i / 8] >> (i % 8) & 1) != 0;
}

void ContourWalk::mark(int x, int y) {
  const std::size_t i =
      static_cast<std::size_t>(y) * static_cast<std::size_t>(image_.width) + static_cast<std::size_t>(x);
  buffers_.marks[i / 8] = static_cast<std::uint8_t>(buffers_.marks[i / 8] | 1U << (i % 8));
}

/// A border is a closed chain of sides of pixels with dark on the right hand. It passes the left side of some dark pixel
/// upwards; that is where it is entered, and those sides are marked.
bool ContourWalk::next(Contour* contour) {
  for (; y_ < image_.height; ++y_, x_ = 0) {
    const std::uint8_t* row = image_.row(y_);
    for (; x_ < image_.width; ++x_) {
      if (row[x_] >= level_ || (x_ > 0 && row[x_ - 1] < level_) || is_marked(x_, y_)) continue;
      follow(x_, y_, contour);
      ++x_;
      return true;
    }
  }
  return false;
}

void ContourWalk::follow(int x, int y, Contour* contour) {
  // Directions: 0 right, 1 down, 2 left, 3 up. From a corner, the pixels ahead on the right and on the left hand.
  constexpr int kStepX[4] = {1, 0, -1, 0}, kStepY[4] = {0, 1, 0, -1};
  constexpr int kRightX[4] = {0, -1, -1, 0}, kRightY[4] = {0, 0, -1, -1};
  constexpr int kLeftX[4] = {0, 0, -1, -1}, kLeftY[4] = {-1, 0, 0, -1};
  const std::size_t capacity = contour_points(image_.width, image_.height);
  std::size_t count = 0;
  long long twice_area = 0;
  contour->min_x = contour->max_x = x;
  contour->min_y = contour->max_y = y;

  // Sides are passed by a permutation, so that the walk comes back to where it began.
  int cx = x, cy = y + 1, direction = 3;
  do {
    if (direction == 3) mark(cx, cy - 1);
    const int nx = cx + kStepX[direction], ny = cy + kStepY[direction];
    twice_area += static_cast<long long>(cx) * ny - static_cast<long long>(nx) * cy;
    cx = nx;
    cy = ny;
    if (count < capacity) {
      buffers_.points[count] = {static_cast<std::uint16_t>(cx), static_cast<std::uint16_t>(cy)};
    }
    ++count;
    if (cx < contour->min_x) contour->min_x = cx;
    if (cx > contour->max_x) contour->max_x = cx;
    if (cy < contour->min_y) contour->min_y = cy;
    if (cy > contour->max_y) contour->max_y = cy;
    if (!is_dark(cx + kRightX[direction], cy + kRightY[direction])) {
      direction = (direction + 1) & 3;
    } else if (is_dark(cx + kLeftX[direction], cy + kLeftY[direction])) {
      direction = (direction + 3) & 3;
    }
  } while (!(cx == x && cy == y + 1 && direction == 3));

  contour->points = buffers_.points;
  contour->count = count <= capacity ? static_cast<int>(count) : 0;
  contour->area = twice_area / 2;
}

}  // namespace pf
