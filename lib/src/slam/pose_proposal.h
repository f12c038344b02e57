#pragma once

#include "filter/state.h"
#include "geometry/camera.h"

/// A pose from matches of which many may be wrong.

namespace pf {

/// What the last frame proposed while the map was searched for.
struct Proposal {
  int frames = 0;  ///< in a row that agree with it
  Quat q_WC = Quat::Identity();
  Vec3 p_W = Vec3::Zero();
  Scalar depth = 1;  ///< median, of what agreed
};

/// The pose that most matches agree with, RANSAC over triples: each is fitted from the prior, with the prior's information, by Gauss-Newton;
/// the best is fitted again to all that agree with it.
///
///   min over (theta, p) of  sum |z - pi(T_CW f)|^2 / sigma^2 + e^T P^-1 e
///
/// P         6x6 of (theta, p), of the prior
/// sigma_px  of a match against the map
/// count     matches, at least 4
/// pose      the prior in, the proposal out; only q_WC and p_W change
/// Returns how many agree within three sigma.
int propose_pose(const Camera& camera, const Mat6& P, const Vec3* f_W, const Vec2* pixel, int count, Scalar sigma_px,
                 Body* pose);

}  // namespace pf
