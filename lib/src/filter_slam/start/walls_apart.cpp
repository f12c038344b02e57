#include "filter_slam/start/walls_apart.h"

#include "base/table_entries.h"
#include "filter_slam/features/wall_rays.h"
#include "filter_slam/start/tuning.h"
#include "map/tuning.h"
#include "model/camera_at.h"

namespace pf {

using namespace tuning::start_before_walls;

bool sees_walls(const Filter& filter, const Map& map, const Body& body) {
  const Camera& lens = filter.lens();
  for (int k = 0; k < kCells * kCells; ++k) {
    const Vec2 pixel((static_cast<Scalar>(k % kCells) + Scalar(0.5)) * static_cast<Scalar>(lens.width) / kCells,
                     (static_cast<Scalar>(k / kCells) + Scalar(0.5)) * static_cast<Scalar>(lens.height) / kCells);
    Vec3 ray_C;
    if (unproject(lens, pixel, &ray_C) && range_in_plan(filter, map, body.p_W, body.q_WC * ray_C) > Scalar(0))
      return true;
  }
  return false;
}

void set_walls_apart(PlaneTable* planes) {
  for (const int k : used_entries(*planes)) (*planes)[k].apart = (*planes)[k].known;
}

Scalar find_scale_by_walls(const Filter& filter, const Map& map, std::int64_t t_ns, const Vec3& c0_W) {
  const State& state = filter.state();
  const Vec3 c_W = camera_at(state, Scalar(0)).p_W;
  Scalar ratio[kMaxRatios];
  int count = 0;
  for (const int k : used_entries(map.planes)) {
    if (!map.planes[k].apart) continue;
    const PlaneFrame& frame = state.frame_of(state.block[map.planes[k].slot]);
    for (int i = 0; i < map.features.capacity() && count < kMaxRatios; ++i) {
      const Feature& f = map.features[i];
      if (!map.features.used(i) || f.last_seen_ns != t_ns) continue;
      if (state.has_inverse_depth(f.slot)) continue;
      const Scalar u = factor_onto_wall(map.planes[k], frame, c0_W, c_W, filter.point(f.slot));
      if (u > Scalar(0)) ratio[count++] = u;
    }
  }
  return clear_factor(ratio, count);
}

void scale_tables(Scalar scale, const Vec3& pivot_W, Map* map) {
  for (const int i : used_entries(map->features))
    if (map->features[i].has_appearance) {
      Vec3& c_W = map->first_view(i).c_W;
      c_W = pivot_W + scale * (c_W - pivot_W);
    }
  for (int i = 0; i < map->planes.capacity(); ++i) {
    if (map->planes[i].known) continue;
    for (PlaneOutline* outline : {&map->planes[i].seen, &map->planes[i].support})
      for (int k = 0; k < outline->count; ++k) outline->uv[k] *= scale;
  }
}

}  // namespace pf
