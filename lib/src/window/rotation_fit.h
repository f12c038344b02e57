#pragma once

#include "geometry/camera.h"
#include "window/adjust.h"

namespace pf {

/// Robust fit of a rotation alone to pixels of known rays, as if they were infinitely far away. Returns the median residual, which is the
/// parallax [px]; 0 where no pixel can be used.
///
/// ray      in W; any length
/// pixel    of each ray
/// scratch  `count` numbers
/// q_WC     first guess in, fit out
Scalar fit_rotation(const Camera& camera, const Vec3* ray, const BundlePixel* pixel, int count, Scalar* scratch,
                    Quat* q_WC);

}  // namespace pf
