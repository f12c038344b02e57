#pragma once

#include "keyframe_slam/map/keyframe_map.h"

/// Depth of a point from the pixels of its keyframes and of this frame, their poses taken as exact.

namespace pf {

struct DepthFit {
  Scalar rho = 0;           ///< [1/m]
  Scalar information = 0;   ///< of rho, for pixels with a standard deviation of one
  Scalar worst_px = 0;      ///< largest residual [px]
  Scalar cos_parallax = 1;  ///< of the angle between the rays of the host and of this frame
};

/// Least squares over rho of all pixels; first guess from the two rays of host and frame:
///
///   s = (r - (r.d) d).b / (1 - (r.d)²),   b = c - c_host,   rho = 1 / s
///
/// r, d   unit rays in W of the host and of the frame
/// false  the rays are parallel or meet behind the host, or the fit is not in front of a camera; fit->cos_parallax is set all the same
bool fit_depth(const Camera& camera, const KeyframeMap& map, int i, const CameraView& now, const Vec2& pixel,
               DepthFit* fit);

struct PixelDepth {
  Scalar rho;       ///< [1/m]
  Scalar variance;  ///< 0: no pixel measures it
};

/// From the pixels of the keyframes, and the prior of a place that has come back, in one step of Gauss-Newton from the present depth:
///
///   rho + sum J.r / sum J²,   variance sigma² / sum J²
PixelDepth depth_by_pixels(const KeyframeMap& map, int i, Scalar sigma_px);

}  // namespace pf
