#pragma once

// Poses that the library gave out, and what its corrections make of them.

#include <algorithm>
#include <cmath>

#include "base/eigen.h"
#include "planefold/planefold.h"

namespace pf {

struct GivenPose {
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  std::uint32_t map_id = 0;

  static GivenPose of(const double* q, const double* p, std::uint32_t map_id) {
    return {{q[0], q[1], q[2], q[3]}, {p[0], p[1], p[2]}, map_id};
  }
  static GivenPose of(const pf_pose_t& pose) { return of(pose.q_WC, pose.p_WC, pose.map_id); }
  static GivenPose of(const pf_anchor_t& anchor) { return of(anchor.q_WA, anchor.p_WA, anchor.map_id); }
  /// The larger one of rotation and distance.
  double distance(const GivenPose& other) const {
    return std::max((p - other.p).norm(), 2 * (q.conjugate() * other.q).vec().norm());
  }
};

struct Correction {
  double scale = 1;
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
  Eigen::Vector3d t = Eigen::Vector3d::Zero();
  std::uint32_t from = 0, to = 0;

  static Correction of(const pf_report_t& r) {
    const double* const w = r.correction_q;
    const double* const t = r.correction_p;
    return {r.correction_scale, {w[0], w[1], w[2], w[3]}, {t[0], t[1], t[2]}, r.correction_from_map_id, r.map_id};
  }
  bool is_identity() const { return scale <= 1 && scale >= 1 && q.vec().norm() <= 0 && t.norm() <= 0 && q.w() >= 1; }
  Eigen::Vector3d of(const Eigen::Vector3d& p) const { return scale * (q * p) + t; }
  /// Poses of other maps stay as they are.
  GivenPose of(const GivenPose& pose) const {
    return pose.map_id == from ? GivenPose{q * pose.q, of(pose.p), to} : pose;
  }
};

}  // namespace pf
