#pragma once

#include "base/eigen.h"

/// What points say together of whether they lie on one plane: lib/docs/theory/planes.md, "A plane is decided jointly".

namespace pf {

inline constexpr int kMaxJoint = 16;  ///< points of a plane that are judged together

/// Distances of points from a plane near them, and what is known of them together.
struct JointDistances {
  int count = 0;
  Scalar d[kMaxJoint];              ///< [m]
  Vec2 uv[kMaxJoint];               ///< places in the plane's frame [m]
  Scalar S[kMaxJoint * kMaxJoint];  ///< covariance [m²], row-major, its lower half; rows are `count` long
};

/// ln p(d = 0 | what is known now) / p(d = 0 | depths of which nothing is known), for distances d from the best plane:
///
///   ln p = -1/2 (ln |V| + ln |Aᵀ V⁻¹ A| + dᵀ (V⁻¹ - V⁻¹ A (Aᵀ V⁻¹ A)⁻¹ Aᵀ V⁻¹) d) + constant,   rows of A: (u, v, 1)
///   V = S + roughness² now;   V = first² + roughness² of first depths, which are independent
///
/// The plane itself is integrated out, so that three points say nothing, and neither does what turns, shifts or scales all points together.
/// Where S is that of first depths, as of points without parallax, it is zero.
///
/// first, roughness  standard deviations of a distance [m]
/// returns           minus infinity where a covariance is none, or there are fewer than three points
Scalar log_odds_of_plane(const JointDistances& points, Scalar first, Scalar roughness);

/// ln of the sets that these points were chosen from: `chosen` of `near` points in a ball, which is drawn about one of `all` points, up to
/// another one; as many points as it has may be chosen.
Scalar log_choices(int chosen, int near, int all);

}  // namespace pf
