#include "frame/start/target_surface.h"

#include "frame/start/tuning.h"
#include "geometry/plane.h"

namespace pf {

Vec3 target_normal(const Target& target) {
  using tuning::start_at_target::kFlatness;
  constexpr int kMinPoints = 4;
  PlaneFit fit;
  if (target.count < kMinPoints || !fit_plane(target.point_W, target.count, target.first_pose.p_W, &fit))
    return Vec3::Zero();
  return fit.lambda(0) < kFlatness * kFlatness * fit.lambda(2) ? Vec3(fit.frame.R_WP.col(2)) : Vec3(Vec3::Zero());
}

}  // namespace pf
