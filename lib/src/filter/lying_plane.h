#pragma once

#include "filter/filter.h"

namespace pf {

/// A plane as others read it: in the frame in which it lies, and not about the one in which it is estimated.
struct LyingPlane {
  PlaneFrame frame;
  Scalar distance = 0;             ///< of the plane from W's origin [m]
  Mat3 covariance = Mat3::Zero();  ///< of (a, b, h) about the frame, or (alpha, beta, delta)
};

LyingPlane lying_plane(const Filter& filter, int slot);
/// A point in the plane's own coordinates, in those of the frame in which it lies.
Vec2 to_lying(const Filter& filter, int slot, const LyingPlane& plane, const Vec2& uv);

}  // namespace pf
