#include "keyframe_slam/adjustment/bundle_planes.h"

#include <algorithm>

#include "base/table_entries.h"
#include "bundle/bearing.h"
#include "bundle/tuning.h"
#include "keyframe_slam/adjustment/tuning.h"
#include "keyframe_slam/map/depth.h"

namespace pf {
namespace {

using namespace tuning::keyframe_adjustment;

bool fits_plane(const KeyframeMap& map, const BundlePlane& plane, int i, Scalar gate, Scalar sigma_px) {
  const PixelDepth depth = depth_by_pixels(map, i, sigma_px);
  if (!(depth.rho > tuning::adjust::kMinPlaneRho)) return false;
  Mat13 J_plane;
  Mat16 J_H;
  Scalar J_rho;
  const Scalar e = bearing_plane_distance(plane, map.ray_W(i), map.keyframes[map.point(i).host].p_W, depth.rho,
                                          &J_plane, &J_H, &J_rho);
  return e * e < gate * (plane.roughness * plane.roughness + J_rho * J_rho * depth.variance);
}

}  // namespace

void add_plane_points(const KeyframeMap& map, AdjustedPoints* points) {
  const std::int16_t *begin = points->row, *end = points->row + points->seen;
  for (const int i : used_entries(map)) {
    if (!map.point(i).has_depth || map.point(i).plane < 0) continue;
    if (std::find(begin, end, i) != end) continue;
    const auto is_on_same = [&](int row) { return map.point(row).plane == map.point(i).plane; };
    if (std::any_of(begin, end, is_on_same)) points->row[points->count++] = static_cast<std::int16_t>(i);
  }
}

void add_planes(const KeyframeMap& map, const KeyframePlanes& planes, const FoldRule& fold, Scalar sigma_px,
                AdjustedPoints* points, AdjustedPlanes* adjusted) {
  int* plane_of = points->plane_of;
  std::fill(plane_of, plane_of + points->count, -1);
  for (const int k : used_entries(planes)) {
    BundlePlane& plane = adjusted->plane[adjusted->count];
    plane = {planes.plane(k).frame, Vec3::Zero(), planes.roughness_of(k), true};
    int members = 0;
    for (int p = 0; p < points->count; ++p) {
      const int row = points->row[p];
      if (map.point(row).plane != k || !fits_plane(map, plane, row, fold.gate, sigma_px)) continue;
      plane_of[p] = adjusted->count;
      ++members;
    }
    if (members < kMinPlanePoints) {
      std::replace(plane_of, plane_of + points->count, adjusted->count, -1);
      continue;
    }
    adjusted->row[adjusted->count++] = k;
  }
}

}  // namespace pf
