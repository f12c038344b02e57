#include "rows.h"

namespace pf::capture {

bool project_row(const pf_camera_t& camera, const pf_pose_t& pose, const Vec3& p_C, double pixel[2]) {
  if (pf_camera_project(&camera, p_C.data(), pixel) != PF_OK) {
    return false;
  }
  const Vec3 w = {pose.w_C[0], pose.w_C[1], pose.w_C[2]};
  const Vec3 v_W = {pose.v_W[0], pose.v_W[1], pose.v_W[2]};
  Vec3 v_C;
  for (size_t i = 0; i < 3; ++i) {
    v_C[i] = dot(rotation_column(pose.q_WC, static_cast<int>(i)), v_W);
  }
  const bool has_rows = camera.readout_s > 0.0 && camera.timestamps == PF_TIMESTAMPS_REAL;
  for (int turn = 0; turn < 3 && has_rows; ++turn) {
    const double tau = camera.readout_s * ((pixel[1] + 0.5) / camera.height - 0.5);
    Vec3 p;
    for (size_t i = 0; i < 3; ++i) {
      p[i] = p_C[i] - tau * v_C[i];
    }
    const Vec3 once = cross(w, p);
    const Vec3 twice = cross(w, once);
    for (size_t i = 0; i < 3; ++i) {
      p[i] += tau * (0.5 * tau * twice[i] - once[i]);  // Exp(-w tau) p: a third power is less than 1e-6 of p
    }
    if (pf_camera_project(&camera, p.data(), pixel) != PF_OK) {
      return false;
    }
  }
  return true;
}

Vec3 to_camera(const pf_pose_t& pose, const Vec3& p_W) {
  const Vec3 r = {p_W[0] - pose.p_WC[0], p_W[1] - pose.p_WC[1], p_W[2] - pose.p_WC[2]};
  return {dot(rotation_column(pose.q_WC, 0), r), dot(rotation_column(pose.q_WC, 1), r),
          dot(rotation_column(pose.q_WC, 2), r)};
}

}  // namespace pf::capture
