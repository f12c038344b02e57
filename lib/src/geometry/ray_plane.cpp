#include "geometry/ray_plane.h"

#include <cmath>

namespace pf {

bool intersect_ray_plane(const PlaneFrame& frame, const Vec3& x, const Vec3& origin_W, const Vec3& direction_W,
                         Vec3* hit_W, Mat3* J_hit_origin, Mat3* J_hit_direction, Mat3* J_hit_x) {
  constexpr Scalar kCos85 = Scalar(0.0871557427);
  const Vec3 m = frame.R_WP * Vec3(-x(0), -x(1), 1);
  const Vec3 foot = frame.o_W + x(2) * frame.R_WP.col(2);
  const Vec3 d = direction_W;
  const Scalar slope = m.dot(d);
  if (!(std::abs(slope) > kCos85 * m.norm() * d.norm())) return false;
  const Scalar t = m.dot(foot - origin_W) / slope;
  if (!(t > 0) || !std::isfinite(t)) return false;
  const Vec3 hit = origin_W + t * d;
  if (J_hit_origin != nullptr || J_hit_direction != nullptr) {
    const Mat3 J = Mat3::Identity() - d * m.transpose() / slope;
    if (J_hit_origin != nullptr) *J_hit_origin = J;
    if (J_hit_direction != nullptr) *J_hit_direction = t * J;
  }
  if (J_hit_x != nullptr) {
    J_hit_x->col(0) = d * (frame.R_WP.col(0).dot(hit - foot) / slope);
    J_hit_x->col(1) = d * (frame.R_WP.col(1).dot(hit - foot) / slope);
    J_hit_x->col(2) = d / slope;
  }
  *hit_W = hit;
  return true;
}

}  // namespace pf
