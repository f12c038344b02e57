#pragma once

#include "base/eigen.h"
#include "geometry/camera.h"
#include "geometry/planar_pose.h"
#include "vision/image_mask.h"
#include "vision/quad.h"

namespace pf {

/// Moves the corners of a quadrilateral to where the lines through its sides meet.
///
/// On every side up to 40 places look across it for the middle of the rise from dark to light. A straight side is a
/// plane through the optical centre, n · ray = 0, whatever the lens does to it: its normal is fitted to the rays of
/// the places, far ones counting less, and a corner is the ray n_i x n_{i+1}. Twice, because the first sides were rough.
///
/// False when a side has too few clear places, is not straight within a pixel, or a corner moves by more than four; quad
/// untouched.
bool refine_quad(const ImageView& image, const Camera& camera, Quad* quad);

/// A dark rectangle of known size, seen.
struct RectangleSighting {
  Quad quad;
  PoseEstimate pose;
  Scalar second_rms_px = 0;  ///< of the mirrored solution, the largest Scalar when there is none
};

/// Finds the dark rectangle of the given size, among the quadrilaterals whose corners a pose explains within
/// 1.5 sigma_px + 0.3 % of their diagonal (right ones: RMS below 1.3 sigma_px in 99.9 % of all cases, because two of the eight
/// coordinates are redundant) and that are slanted by at most 70 degrees. Other rectangles pass when a slant makes up for
/// the wrong ratio of their sides, so the best is the largest, of strong contrast, seen frontally, and well explained.
///
/// width, height  of the outer edge of the dark area [m]
/// sigma_px       of a corner's coordinate [px]
/// mask           none with a corner, or more than half of a side, on what it masks; may be null
/// false when there is none
bool find_dark_rectangle(const ImageView& image, const Camera& camera, Scalar width, Scalar height, Scalar sigma_px,
                         const QuadWorkspace& workspace, RectangleSighting* out, const ImageMask* mask = nullptr);

/// Whether no corner of a quadrilateral and at most half of each side lie on what is masked. True without a mask.
bool is_in_scene(const Quad& quad, const ImageMask* mask);

}  // namespace pf
