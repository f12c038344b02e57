#pragma once

#include <cstddef>

#include "base/arena.h"
#include "base/eigen.h"
#include "vision/contour.h"
#include "vision/image.h"

namespace pf {

/// A dark convex quadrilateral on a light ground.
struct Quad {
  Vec2 corners[4];      ///< [px] top left, top right, bottom right, bottom left, in the order nearest to upright
  Scalar contrast = 0;  ///< light outside less dark inside, at the weakest of the four sides [grey levels]
  Scalar area = 0;      ///< [px²]
  Scalar rms_px = 0;    ///< how straight the sides are, once refined [px]
};

/// Memory that find_dark_quads works in, from the arena.
struct QuadWorkspace {
  ContourBuffers buffers = {nullptr, nullptr};
};
QuadWorkspace take_quad_workspace(Arena* arena, int width, int height);

/// Finds dark quadrilaterals, to about a pixel; the sharp position needs the camera (track/quad_refine.h).
///
/// At seven levels between the image's darkest and lightest parts: regions of dark pixels, their outlines, the four
/// corners of outlines that are quadrilateral, and the contrast across every side. The same quadrilateral at several
/// levels is given once, from the level nearest to the middle between inside and outside. Sides may bulge a little, as
/// lenses make them. The area is at least 0.2 % of the image, and no corner is at the image's border.
///
/// returns  how many were found, at most capacity, the strongest contrast first
int find_dark_quads(const ImageView& image, const QuadWorkspace& workspace, Quad* out, int capacity);

}  // namespace pf
