#pragma once

#include "base/eigen.h"
#include "vision/pyramid.h"

namespace pf {

/// Side of the window that is aligned, and of the template for it: one more on each side, for its gradients.
constexpr int kAlignSize = 11;
constexpr int kWarpSize = kAlignSize + 2;

/// The stored image around a feature, from which templates for other views are made: pixels of level 0, and pixels of
/// level 1 over twice the width for views from further away. What would lie outside of the image repeats its edge and is
/// never handed out. A plain copy: no pointers.
struct SourcePatch {
  static constexpr int kSize = 32;
  static constexpr int kLevels = 2;

  std::uint8_t pixels[kLevels][kSize * kSize];
  float centre_x[kLevels], centre_y[kLevels];  // where the feature is in the patch [px of that level]
  std::uint8_t begin_x[kLevels], end_x[kLevels], begin_y[kLevels], end_y[kLevels];  // what is inside the image
};

/// Copies the surroundings of a pixel of level 0. Costs about as much as copying 2 kB.
/// False, patch untouched: not finite, or nearer to the edge than an upright template needs (kWarpSize / 2 + 1 px).
bool extract_source(const Pyramid& pyramid, const Vec2& pixel, SourcePatch* patch);

/// Template of a feature as the current image should show it:
///
///   out(row j, column i) = S(A (i - c, j - c)),  c = (size - 1) / 2, S bilinear about the feature
///
/// A      2x2, px of source level 0 per px of the current image's search level
/// size   side of the template, 1 .. SourcePatch::kSize
/// out    size * size grey levels, row by row
/// Where A steps over more than about 1.6 px, level 1 of the source is read, to avoid aliasing.
/// False, out untouched: A is not finite, or the template would leave the patch or the image that it came from.
/// Costs about 2 ns per pixel of the template.
bool warp_template(const SourcePatch& patch, const Mat2& A_source_current, int size, float* out);

/// Whether warp_template() would make that template. Costs some 5 ns.
bool has_template(const SourcePatch& patch, const Mat2& A_source_current, int size);

}  // namespace pf
