#pragma once

#include "planefold/planefold.h"
#include "sim/linear.h"

namespace pfsim {

/// From one pose to another in the terms of their covariance, R_b = Exp(theta) R_a and p_b = p_a + e_p.
struct PoseDifference {
  double e[6];    ///< theta [rad], e_p [m]
  double rad, m;  ///< their lengths
};

inline PoseDifference pose_difference(const pf_pose_t& a, const pf_pose_t& b) {
  const pf::sim::Vec3 theta =
      pf::sim::rotation_log(pf::sim::rotation_of(b.q_WC) * pf::sim::rotation_of(a.q_WC).transposed());
  const pf::sim::Vec3 p = {b.p_WC[0] - a.p_WC[0], b.p_WC[1] - a.p_WC[1], b.p_WC[2] - a.p_WC[2]};
  return {{theta.x, theta.y, theta.z, p.x, p.y, p.z}, theta.norm(), p.norm()};
}

}  // namespace pfsim
