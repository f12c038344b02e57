#include "filter_slam/planes/plane_lifecycle.h"

#include <algorithm>

#include "base/table_entries.h"
#include "filter_slam/planes/plane_folding.h"
#include "filter_slam/planes/plane_points.h"
#include "frame/tuning.h"

namespace pf {

using namespace tuning::plane_lifecycle;

void settle_frame(Filter& filter, Map& map, int plane_entry) {
  const int plane = map.planes[plane_entry].slot;
  const State& state = filter.state();
  const Block& block = state.block[plane];
  const Vec3 x = block.xyz();
  if (map.planes[plane_entry].prior[0] > Scalar(0)) return;
  const bool slanted = x(0) * x(0) + x(1) * x(1) > kMaxSlant * kMaxSlant;
  if (!slanted || filter.group_of(plane) >= 0) return;
  PlaneFrame to = state.frame_of(block);
  Vec3 normal;
  Scalar d;
  plane_normal(to, x, &normal, &d);
  to.o_W += x(2) * to.R_WP.col(2);
  const Vec3 along = (to.R_WP.col(0) - normal * normal.dot(to.R_WP.col(0))).normalized();
  to.R_WP.col(0) = along;
  to.R_WP.col(1) = normal.cross(along);
  to.R_WP.col(2) = normal;
  const PlaneFrame from = state.frame_of(block);
  if (!filter.reanchor(plane, to)) return;
  PlaneOutline& known = map.planes[plane_entry].support;
  PlaneOutline& seen = map.planes[plane_entry].seen;
  PlaneOutline& plan = map.planes[plane_entry].plan;
  for (PlaneOutline* outline : {&known, &seen, &plan})
    for (int i = 0; i < outline->count; ++i)
      outline->uv[i] = plane_coordinates(to, plane_point(from, x, outline->uv[i]));
}

void dissolve_plane(Filter& filter, Map& map, FeatureKeeper& features, Scalar sigma_normal, int plane_entry) {
  const int plane = map.planes[plane_entry].slot;
  filter.state().for_each_planar(plane, [&](int slot) {
    const int feature = filter.state().block[slot].owner;
    if (map.features[feature].on_trial || !filter.unfold(slot, sigma_normal)) features.drop(&feature, 1);
  });
  filter.remove(&plane, 1);
  map.planes.remove(plane_entry);
}

void dissolve_weak(const Settings& settings, Filter& filter, Map& map, FeatureKeeper& features) {
  for (const int i : used_entries(map.planes)) {
    if (map.planes[i].known) continue;
    const PlanePoints on = outline_plane(filter, map, i, nullptr);
    const int points = on.folded - on.on_trial;
    if (map.planes[i].remembered && points == 0) continue;
    map.planes[i].max_points = std::max<int>(map.planes[i].max_points, points);
    const int upheld = map.planes[i].upheld;
    const bool proven = map.planes[i].max_points > settings.plane_min_points || upheld > 0;
    map.planes[i].weak = points < kMinPoints || !proven ? map.planes[i].weak + 1 : 0;
    const bool denied = map.planes[i].outliers > points + PlaneEntry::kUpheldWorth * upheld;
    if (!denied && map.planes[i].weak <= kMaxWeakFrames) continue;
    if (denied || !proven) filter.forget_through(map.planes[i].slot, wrong_points_sigma(settings));
    dissolve_plane(filter, map, features, settings.plane_distance, i);
  }
}

}  // namespace pf
