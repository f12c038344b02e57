#pragma once

#include <cstddef>
#include <cstdint>

#include "vision/image.h"

namespace pf {

/// A corner between pixels: (x, y) is the top-left corner of pixel (x, y), at (x - 0.5, y - 0.5) in pixel coordinates.
struct ContourPoint {
  std::uint16_t x, y;
};

/// The border between dark and light around one dark region, clockwise as seen.
struct Contour {
  const ContourPoint* points;  ///< every corner passed, in order
  int count;                   ///< 0 when the border was longer than the buffer; the rest is right all the same
  long long area;              ///< enclosed [px²]; negative for the border of a light hole
  int min_x, min_y, max_x, max_y;
};

/// Memory for following borders, from the caller.
struct ContourBuffers {
  std::uint8_t* marks;   ///< one bit a pixel: contour_mark_bytes
  ContourPoint* points;  ///< contour_points
};

/// A convex outline passes at most 2 (width + height) corners; twice that leaves room for ragged ones.
inline std::size_t contour_points(int width, int height) {
  return 4 * (static_cast<std::size_t>(width) + static_cast<std::size_t>(height));
}
inline std::size_t contour_mark_bytes(int width, int height) {
  return (static_cast<std::size_t>(width) * static_cast<std::size_t>(height) + 7) / 8;
}

/// Follows the borders of the regions (joined by sides) of pixels below a level, one after the other. Every border is
/// given once; the work over a whole image is at most some steps per pixel, whatever the image holds.
///
///   ContourWalk walk(image, level, buffers);
///   while (walk.next(&contour)) ...
class ContourWalk {
 public:
  ContourWalk(const ImageView& image, int level, const ContourBuffers& buffers);
  bool next(Contour* contour);

 private:
  bool is_dark(int x, int y) const { return image_.contains(x, y) && image_.at(x, y) < level_; }
  bool is_marked(int x, int y) const;
  void mark(int x, int y);
  void follow(int x, int y, Contour* contour);

  ImageView image_;
  int level_;
  ContourBuffers buffers_;
  int x_ = 0, y_ = 0;
};

}  // namespace pf
