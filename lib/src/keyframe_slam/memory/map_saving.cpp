#include "keyframe_slam/memory/map_saving.h"

#include <algorithm>

#include "base/table_entries.h"
#include "keyframe_slam/map/tuning.h"
#include "keyframe_slam/memory/keyframe_anchors.h"

namespace pf {

bool MapSaving::layout(Arena& arena) {
  if (settings_.kept.places == 0) return arena.ok();
  source_ = arena.take<Source>(static_cast<std::size_t>(settings_.kept.places + tuning::keyframe_map::kKeyframes));
  return arena.ok();
}

/// Places that are not in the window, and keyframes that see enough for a place, by their ids. Returns how many.
int MapSaving::list_sources() const {
  int count = 0;
  for (const int k : used_entries(map_.keyframes)) {
    if (!make_place(map_, k, nullptr, scratch())) continue;
    source_[count++] = {scratch()->id,
                        -1,
                        static_cast<std::int16_t>(k),
                        static_cast<std::int16_t>(scratch()->count),
                        true,
                        scratch()->depth,
                        scratch()->q_WK,
                        scratch()->p_WK};
  }
  const int keyframes = count;
  for (const int p : used_entries(map_.places)) {
    const KeptPlace& place = map_.places[p];
    if (!map_.places.is_present(p)) continue;
    const bool is_keyframe =
        std::any_of(source_, source_ + keyframes, [&](const Source& other) { return other.id == place.id; });
    if (is_keyframe) continue;
    source_[count++] = {place.id,   static_cast<std::int16_t>(p),
                        -1,         static_cast<std::int16_t>(place.count),
                        true,       place.depth,
                        place.q_WK, place.p_WK};
  }
  std::sort(source_, source_ + count, [](const Source& a, const Source& b) { return a.id < b.id; });
  return count;
}

/// Leaves the capacity of places chosen: of the two that are nearest to each other goes the one with fewer points, the older one among
/// equals.
void MapSaving::thin_out(int count) const {
  for (int left = count; left > settings_.kept.places; --left) {
    int worst = -1;
    Scalar nearest = 0;
    for (int i = 0; i < count; ++i)
      for (int j = i + 1; j < count && source_[i].chosen; ++j) {
        const Source &a = source_[i], &b = source_[j];
        if (!b.chosen) continue;
        const Scalar d2 = view_distance2(a.q_WK, a.p_WK, a.depth, b.q_WK, b.p_WK, b.depth);
        if (worst >= 0 && !(d2 < nearest)) continue;
        nearest = d2;
        worst = b.points < a.points ? j : i;
      }
    source_[worst].chosen = false;
  }
}

Status MapSaving::save(const Vec3& gravity_W, std::uint32_t map_id, MapWriter* out) const {
  const int count = list_sources();
  if (count == 0) return Status::kNothing;
  thin_out(count);
  out->begin(kPortableMap);
  write_lens(map_.camera(), out);
  write_world(gravity_W, out);
  write_planes(out);
  write_places(count, out);
  write_anchors(map_.tables().anchors, map_id, out,
                [&](const Anchor& anchor) { return held_by_chosen(anchor, count); });
  out->end();
  return Status::kOk;
}

void MapSaving::write_planes(MapWriter* out) const {
  const PlaneTable& table = map_.tables().planes;
  int count = 0;
  for (const int k : used_entries(table)) count += k >= 0 ? 1 : 0;
  begin_planes(count, out);
  for_each_by_id(table, [&](int k) {
    const KeyframePlane& plane = planes_.plane(k);
    SavedPlane saved;
    saved.id = table[k].id;
    saved.max_points = static_cast<std::uint32_t>(static_cast<int>(table[k].max_points));
    saved.frame = plane.frame;
    saved.covariance = plane.covariance;
    saved.outline = table[k].seen;
    write_plane(saved, out);
  });
  out->end_section();
}

void MapSaving::write_places(int count, MapWriter* out) const {
  KeptPlace* const place = scratch();
  bool* const taken = keeper_.taken();
  std::fill(taken, taken + map_.capacity(), false);
  for (int i = 0; i < count; ++i)
    if (source_[i].chosen && source_[i].place >= 0) mark_taken(map_, map_.places[source_[i].place], taken);
  begin_places(static_cast<int>(std::count_if(source_, source_ + count, [](const Source& s) { return s.chosen; })),
               out);
  for (int i = 0; i < count; ++i) {
    const Source& source = source_[i];
    if (!source.chosen) continue;
    if (source.keyframe >= 0)
      make_place(map_, source.keyframe, taken, place);
    else
      *place = map_.places[source.place];
    mark_taken(map_, *place, taken);
    for (int k = 0; k < place->count; ++k) {  // a plane that was merged or dissolved since
      std::uint32_t& plane = place->point[k].plane;
      plane = map_.tables().planes.find(plane);
    }
    write_place(*place, out);
  }
  out->end_section();
}

/// The anchor as one of the places that are saved holds it: its own, or else the nearest.
Anchor MapSaving::held_by_chosen(const Anchor& anchor, int count) const {
  Anchor saved = anchor;
  saved.plane = map_.tables().planes.find(anchor.plane);
  if (saved.plane == 0) saved.leave_plane();
  int nearest = -1;
  Scalar least = 0;
  for (int i = 0; i < count; ++i) {
    const Source& source = source_[i];
    if (!source.chosen) continue;
    if (source.id == anchor.place || anchor.place == 0) return saved;
    const Scalar d2 =
        view_distance2(anchor.T_WV.q, anchor.T_WV.p, source.depth, source.q_WK, source.p_WK, source.depth);
    if (nearest >= 0 && !(d2 < least)) continue;
    least = d2;
    nearest = i;
  }
  saved.hold_by(source_[nearest].id, {source_[nearest].q_WK, source_[nearest].p_WK});
  return saved;
}

Status MapSaving::load(const SavedMap& saved, std::uint32_t map_id) {
  if (saved.num_places() > settings_.kept.places || saved.num_planes() > settings_.max_planes ||
      saved.num_anchors() > settings_.kept.anchors)
    return Status::kFull;
  Map& tables = map_.tables();
  saved.for_each_plane([&](const SavedPlane& plane) {
    const int k = tables.planes.restore(plane.id);
    PlaneEntry& entry = tables.planes[k];
    entry.max_points = static_cast<int>(plane.max_points);
    entry.seen = entry.support = plane.outline;
    planes_.restore(k, plane.frame, plane.covariance);
  });
  saved.for_each_place(scratch(), [&](const KeptPlace& place) { map_.places.keep(place); });
  saved.for_each_anchor([&](const Anchor& anchor) {
    const int entry = tables.anchors.find_free();
    tables.anchors.restore(entry, anchor);
    tables.anchors[entry].map_id = map_id;
  });
  tables.features.reserve_ids(saved.last_feature());
  map_.keyframes.number_from(static_cast<int>(saved.last_place()));
  KeyframeAnchors(tables.anchors, map_, planes_).follow(map_id, map_.places[0].depth);
  is_loaded_ = true;
  return Status::kOk;
}

}  // namespace pf
