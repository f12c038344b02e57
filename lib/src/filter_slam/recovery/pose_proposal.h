#pragma once

#include "geometry/camera.h"
#include "model/state.h"

/// A pose from matches with known points, of which many may be wrong.

namespace pf {

/// RANSAC over triples: each is fitted from the prior, with the prior's information, by Gauss-Newton; the best is fitted again to all of
/// its inliers.
///
///   min over (theta, p) of  sum |z - pi(T_CW f)|^2 / sigma^2 + e^T P^-1 e,   e = (theta, p) of the pose against the prior
///
/// P         6x6 of (theta, p), of the prior
/// f_W       points, without uncertainty
/// sigma_px  of a match
/// count     matches, at least 4
/// pose      the prior in, the proposal out; only q_WC and p_W change
/// Returns the number of inliers: matches within three sigma.
int propose_pose(const Camera& camera, const Mat6& P, const Vec3* f_W, const Vec2* pixel, int count, Scalar sigma_px,
                 Body* pose);

}  // namespace pf
