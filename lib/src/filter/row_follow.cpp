#include "filter/row_follow.h"

#include <algorithm>

#include "filter/tuning.h"

namespace pf {

Mat2 row_follow(const CameraAt& camera, const Mat26& J_camera, Scalar k) {
  Mat2 M = Mat2::Identity();
  Vec2 drift;
  for (int a = 0; a < 2; ++a) {
    const Vec3 J_theta = J_camera.block<1, 3>(a, 0).transpose(), J_p = J_camera.block<1, 3>(a, 3).transpose();
    drift(a) = J_theta.dot(camera.q_WC * camera.w_C) + J_p.dot(camera.v_W);
  }
  const Scalar own = std::max(Scalar(1) - k * drift.y(), tuning::pixel::kMinRowRate);
  M(0, 1) = k * drift.x() / own;
  M(1, 1) = Scalar(1) / own;
  return M;
}

}  // namespace pf
