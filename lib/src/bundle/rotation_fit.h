#pragma once

#include "bundle/bundle.h"
#include "geometry/camera.h"

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

/// Residual of a unit of translation in pixels to which a rotation was fitted, with all points at a distance of one: squared, a mean over
/// the pixels, by the direction of the translation.
///
///   A = (H_tt - H_tr H_rr⁻¹ H_rt) / n,   H = sum [J_r J_t]ᵀ [J_r J_t]                       [px^2 per squared distance]
///
/// A translation by t leaves a residual of sqrt(tᵀ A t) px (root of the mean square), and more where distances differ.
/// False where no pixel can be used or they do not determine a rotation.
bool translation_left(const Camera& camera, const Vec3* ray, const BundlePixel* pixel, int count, const Quat& q_WC,
                      Mat3* A);

}  // namespace pf
