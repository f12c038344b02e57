#include "filter_slam/features/wall_rays.h"
#include "filter_slam/start/filter_start.h"
#include "filter_slam/start/tuning.h"
#include "geometry/common_ratio.h"
#include "model/camera_at.h"

/// FilterStart: at a known pose that sees no wall of the plan. The map is one of points until a wall comes into view (lib/docs/walls.md).

namespace pf {

using namespace tuning::start_before_walls;

/// Whether the plan has a wall where the first pose looks; without a plan, or where the pose does not come from the caller, too.
bool FilterStart::sees_walls() const {
  if (settings_.inertial || !data_.known.given || !parts_.map.planes.has_known()) return true;
  const Camera& lens = parts_.filter.lens();
  for (int k = 0; k < kCells * kCells; ++k) {
    const Vec2 pixel((static_cast<Scalar>(k % kCells) + Scalar(0.5)) * static_cast<Scalar>(lens.width) / kCells,
                     (static_cast<Scalar>(k / kCells) + Scalar(0.5)) * static_cast<Scalar>(lens.height) / kCells);
    Vec3 ray_C;
    const Body& body = data_.known.body;
    if (unproject(lens, pixel, &ray_C) &&
        range_in_plan(parts_.filter, parts_.map, body.p_W, body.q_WC * ray_C) > Scalar(0))
      return true;
  }
  return false;
}

/// Walls tell the size of the map, but not before one of them is seen: until then nothing is compared with them.
void FilterStart::keep_walls_apart() {
  PlaneTable& planes = parts_.map.planes;
  for (int k = 0; k < planes.capacity(); ++k)
    if (planes.used(k)) planes[k].apart = planes[k].known;
  clear_all_but_walls();
}

/// The record's unit of length is a guess, which is as good as any.
void FilterStart::open_scale() { parts_.filter.open_scale(kOpenScale * kOpenScale, data_.known.body.p_W); }

///   u = n . (o - c0) / n . (f - c0)      a wall through o, a point at f: c0 + u (f - c0) lies on it. c0: the first pose, which is known
Scalar FilterStart::look_for_walls() {
  PlaneTable& planes = parts_.map.planes;
  const State& state = parts_.filter.state();
  if (!has_walls_apart() || is_recording()) return Scalar(0);
  const Vec3 c0_W = data_.known.body.p_W, c_W = camera_at(state, Scalar(0)).p_W;
  Scalar ratio[kMaxRatios];
  int count = 0;
  for (int k = 0; k < planes.capacity(); ++k) {
    if (!planes.used(k) || !planes[k].apart) continue;
    const PlaneFrame& frame = state.frame_of(state.block[planes[k].slot]);
    const Vec3 n_W = frame.R_WP.col(2);
    for (int i = 0; i < parts_.map.features.capacity() && count < kMaxRatios; ++i) {
      const Feature& f = parts_.map.features[i];
      if (!parts_.map.features.used(i) || f.last_seen_ns != parts_.frame.report.t_ns) continue;
      if (state.block[f.slot].kind == BlockKind::kInverseDepth) continue;
      const Vec3 to_W = parts_.filter.point(f.slot) - c0_W;
      const Scalar u = n_W.dot(frame.o_W - c0_W) / n_W.dot(to_W);
      if (!(u > Scalar(0)) || !outline_contains(planes[k].plan, plane_coordinates(frame, Vec3(c0_W + u * to_W))))
        continue;
      const Scalar before = n_W.dot(Vec3(c0_W + u * (c_W - c0_W)) - frame.o_W);
      if (before > Scalar(0) || planes[k].two_sided) ratio[count++] = u;
    }
  }
  const CommonRatio common = find_common_ratio(ratio, count, kOneWall);
  if (common.votes < kMinOnWall || common.votes < kClearMajority * common.others) return Scalar(0);
  parts_.filter.join_planes_apart(common.ratio, c0_W);
  scale_tables(common.ratio, c0_W);
  for (int k = 0; k < planes.capacity(); ++k) planes[k].apart = false;
  data_.knows_scale = true;
  parts_.tracking.rename_map();
  settings_.hooks.say("a wall of the plan came into view: the map has its size from here on");
  return common.ratio;
}

/// What the map keeps of lengths and places beside the filter.
void FilterStart::scale_tables(Scalar scale, const Vec3& pivot) {
  Map& map = parts_.map;
  for (int i = 0; i < map.features.capacity(); ++i)
    if (map.features.used(i) && map.features[i].has_appearance) {
      Vec3& c_W = map.first_view(i).c_W;
      c_W = pivot + scale * (c_W - pivot);
    }
  for (int i = 0; i < map.planes.capacity(); ++i) {
    if (map.planes[i].known) continue;
    for (PlaneOutline* outline : {&map.planes[i].seen, &map.planes[i].support})
      for (int k = 0; k < outline->count; ++k) outline->uv[k] *= scale;
  }
}

}  // namespace pf
