#pragma once

#include "base/arena.h"
#include "vision/image.h"
#include "vision/image_mask.h"

namespace pf {

struct Corner {
  float x = 0;
  float y = 0;
  float score = 0;  // min_eigenvalue there
};

/// Minimum distance of a corner from the image's edge [px], which the score of a 7x7 window needs.
constexpr int kCornerBorder = 5;

/// The same from what a mask leaves out [px]: half of the template that is cut there.
constexpr int kMaskMargin = 6;

/// Scratch for detect_corners: three rows of scores and of candidates, about 18 bytes per column.
struct CornerWorkspace {
  float* score[3] = {};
  std::uint16_t* candidate[3] = {};
  int width = 0;

  bool layout(Arena& arena, int image_width);
};

/// Corners in a rectangle: the FAST segment test (of 16 pixels on a circle of radius 3, 9 in a row are all brighter or all
/// darker than the centre by more than `threshold`), scored with min_eigenvalue, and only where no pixel of the 3x3
/// around has a higher score.
///
/// roi         any; it is clipped to the image less kCornerBorder
/// threshold   grey levels, clamped to 1 .. 254
/// out         the best `capacity` of them, best first
/// mask        none nearer to what it masks than kMaskMargin; may be null
/// returns how many
/// Time and scratch are proportional to the rectangle. src: Rosten and Drummond 2006 (segment test), Shi and Tomasi 1994.
int detect_corners(const ImageView& image, const Rect& roi, int threshold, Corner* out, int capacity,
                   const CornerWorkspace& workspace, const ImageMask* mask = nullptr);

/// The segment test at one pixel, at least 3 from the edge: the plain twin of what detect_corners runs on 16 at once.
bool is_segment_corner(const ImageView& image, int x, int y, int threshold);

/// Smaller eigenvalue of the mean of g gᵀ over the 7x7 pixels around (x, y), g the central difference [grey/px].
/// Zero nearer to the edge than kCornerBorder. The reference is the plain twin.
float min_eigenvalue(const ImageView& image, int x, int y);
float min_eigenvalue_reference(const ImageView& image, int x, int y);

}  // namespace pf
