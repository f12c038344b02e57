#include <algorithm>
#include <cmath>

#include "bundle/tuning.h"
#include "keyframe_slam/adjustment/adjustment.h"
#include "keyframe_slam/adjustment/tuning.h"
#include "keyframe_slam/map/depth.h"

/// The planes of KeyframeAdjustment, and the points on them.

namespace pf {

using namespace tuning::keyframe_adjustment;

/// Points of the planes in sight that the keyframes of the bundle do not see: what they say of their planes belongs there. Returns how many
/// points there are with them.
int KeyframeAdjustment::add_plane_points(int points) {
  const int seen = points;
  for (int i = 0; i < map_.capacity(); ++i) {
    if (!map_.used(i) || !map_.point(i).has_depth || map_.point(i).plane < 0) continue;
    if (std::find(row_, row_ + seen, i) != row_ + seen) continue;
    const auto is_on_same = [&](int row) { return map_.point(row).plane == map_.point(i).plane; };
    if (std::any_of(row_, row_ + seen, is_on_same)) row_[points++] = static_cast<std::int16_t>(i);
  }
  return points;
}

/// Holds a point that the bundle has no pixels of, from one row on, by what those of its keyframes say.
void KeyframeAdjustment::hold_by_pixels(int first, int points) {
  for (int p = first; p < points; ++p) {
    const PixelDepth depth = depth_by_pixels(map_, row_[p], noise_.sigma_info());
    prior_[p] = depth.variance > Scalar(0) ? RhoPrior{depth.rho, std::sqrt(depth.variance)} : RhoPrior{rho_[p], 0};
  }
}

/// Whether a point's own pixels place it on a plane, within its roughness.
///
///   e² < gate (roughness² + (de/drho)² variance)
bool KeyframeAdjustment::fits_plane(const BundlePlane& plane, int i) const {
  const PixelDepth depth = depth_by_pixels(map_, i, noise_.sigma_info());
  if (!(depth.rho > tuning::adjust::kMinPlaneRho)) return false;
  Mat13 J_plane;
  Mat16 J_H;
  Scalar J_rho;
  const Scalar e = bearing_plane_distance(plane, map_.ray_W(i), map_.keyframes[map_.point(i).host].p_W, depth.rho,
                                          &J_plane, &J_H, &J_rho);
  return e * e < settings_.fold.gate * (plane.roughness * plane.roughness + J_rho * J_rho * depth.variance);
}

/// Planes with enough points in the bundle; points that do not fit are not held to them. Returns how many planes.
int KeyframeAdjustment::add_planes(int points) {
  int planes = 0;
  std::fill(plane_of_, plane_of_ + points, -1);
  for (int k = 0; k < planes_.capacity(); ++k) {
    if (!planes_.used(k)) continue;
    plane_[planes] = {planes_.plane(k).frame, Vec3::Zero(), settings_.fold.roughness, true};
    int members = 0;
    for (int p = 0; p < points; ++p) {
      if (map_.point(row_[p]).plane != k || !fits_plane(plane_[planes], row_[p])) continue;
      plane_of_[p] = planes;
      ++members;
    }
    if (members < kMinPlanePoints) {
      std::replace(plane_of_, plane_of_ + points, planes, -1);
      continue;
    }
    plane_row_[planes++] = k;
  }
  return planes;
}

void KeyframeAdjustment::take_planes_back(int planes, bool determined) {
  for (int j = 0; j < planes && determined; ++j)
    planes_.take_adjusted(plane_row_[j], plane_[j].x, adjuster_.plane_covariance(j));
}

}  // namespace pf
