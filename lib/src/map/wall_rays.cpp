#include "map/wall_rays.h"

#include "geometry/common_ratio.h"
#include "geometry/ray_plane.h"
#include "map/tuning.h"

namespace pf {

bool meets_outline(const PlaneAt& at, bool two_sided, const PlaneOutline& outline, const Vec3& origin_W,
                   const Vec3& direction_W, Scalar* range) {
  Vec3 hit_W;
  if (!two_sided && !(plane_distance(at.frame, at.x, origin_W) > Scalar(0))) return false;
  if (!intersect_ray_plane(at.frame, at.x, origin_W, direction_W, &hit_W)) return false;
  if (!outline_contains(outline, plane_coordinates(at.frame, hit_W))) return false;
  *range = (hit_W - origin_W).norm() / direction_W.norm();
  return true;
}

Scalar factor_onto_wall(const PlaneEntry& wall, const PlaneFrame& plan, const Vec3& c0_W, const Vec3& c_W,
                        const Vec3& f_W) {
  const Vec3 n_W = plan.R_WP.col(2), to_W = f_W - c0_W;
  const Scalar u = n_W.dot(plan.o_W - c0_W) / n_W.dot(to_W);
  if (!(u > Scalar(0)) || !outline_contains(wall.plan, plane_coordinates(plan, Vec3(c0_W + u * to_W)))) return 0;
  const Scalar before = n_W.dot(Vec3(c0_W + u * (c_W - c0_W)) - plan.o_W);
  return before > Scalar(0) || wall.two_sided ? u : Scalar(0);
}

Scalar clear_factor(Scalar* factors, int count) {
  using namespace tuning::start_before_walls;
  const CommonRatio common = find_common_ratio(factors, count, kOneWall);
  return common.votes >= kMinOnWall && common.votes >= kClearMajority * common.others ? common.ratio : Scalar(0);
}

}  // namespace pf
