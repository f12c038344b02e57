#include "base/table_entries.h"
#include "filter/lying_plane.h"
#include "filter_slam/memory/filter_memory.h"
#include "filter_slam/planes/plane_points.h"

/// FilterMemory: what it writes (lib/docs/reference/map_format.md).

namespace pf {

Status FilterMemory::save(const Vec3& gravity_W, std::uint32_t map_id, MapWriter* out) const {
  if (places_.table().count() == 0 && !maker_.make(scratch_)) return Status::kNothing;
  out->begin(kPortableMap);
  write_lens(filter_.lens(), out);
  write_world(gravity_W, out);
  write_planes(out);
  const int left_out = write_places(out);
  write_anchors(map_.anchors, map_id, out, [&](const Anchor& anchor) { return held_by_place(anchor, left_out); });
  out->end();
  return Status::kOk;
}

/// A plane of a loaded map that nothing has been measured of is written as it was.
void FilterMemory::write_planes(MapWriter* out) const {
  int count = 0;
  for (const int k : used_entries(map_.planes)) count += k >= 0 ? 1 : 0;
  begin_planes(count, out);
  for_each_by_id(map_.planes, [&](int k) {
    const PlaneEntry& entry = map_.planes[k];
    const LyingPlane plane = lying_plane(filter_, entry.slot);
    SavedPlane saved;
    saved.id = entry.id;
    saved.max_points = static_cast<std::uint32_t>(static_cast<int>(entry.max_points));
    saved.frame = plane.frame;
    outline_plane(filter_, map_, k, &saved.outline);
    if (record_[k].id == entry.id && filter_.state().block[entry.slot].xyz() == Vec3::Zero()) {
      saved.frame = filter_.state().frame_of(filter_.state().block[entry.slot]);
      saved.covariance = record_[k].covariance;
    } else {
      const Mat3 J = plane_error_jacobian();
      saved.covariance = J.lazyProduct(plane.covariance).lazyProduct(J.transpose());
      for (int i = 0; i < saved.outline.count; ++i)
        saved.outline.uv[i] = to_lying(filter_, entry.slot, plane, saved.outline.uv[i]);
    }
    write_plane(saved, out);
  });
  out->end_section();
}

/// Those of the table and the one that was begun, which has the greatest id. Returns the entry of the one that it replaces, or of none;
/// capacity(): there is no new one, or it is not written.
int FilterMemory::write_places(MapWriter* out) const {
  const PlaceTable& table = places_.table();
  const int none = table.capacity();
  const int at = maker_.make(scratch_) ? table.entry_for(*scratch_) : none;
  const bool has_new = at != none;
  begin_places(table.count() + (has_new && !table.used(at) ? 1 : 0), out);
  const auto write = [&] {
    for (int i = 0; i < scratch_->count; ++i) {  // a plane that was merged or dissolved since
      std::uint32_t& plane = scratch_->point[i].plane;
      plane = map_.planes.find(plane);
    }
    write_place(*scratch_, out);
  };
  for_each_by_id(table, [&](int p) {
    if (p == at) return;
    *scratch_ = table[p];
    write();
  });
  if (has_new && maker_.make(scratch_)) write();
  out->end_section();
  return at;
}

/// The anchor as one of the places that are written holds it: its own, or else the nearest. The scratch has the new one, where left_out
/// says that there is one.
Anchor FilterMemory::held_by_place(const Anchor& anchor, int left_out) const {
  const PlaceTable& table = places_.table();
  Anchor saved = anchor;
  saved.plane = map_.planes.find(anchor.plane);
  if (saved.plane == 0) saved.leave_plane();
  const int own = table.entry_of(anchor.place);
  if ((own >= 0 && own != left_out) || (anchor.place == 0 && anchor.camera == Anchor::kNoCamera)) return saved;
  const KeptPlace* nearest = nullptr;
  Scalar least = 0;
  const auto offer = [&](const KeptPlace& place) {
    const Scalar d2 = view_distance2(anchor.T_WV.q, anchor.T_WV.p, place.depth, place.q_WK, place.p_WK, place.depth);
    if (nearest != nullptr && !(d2 < least)) return;
    least = d2;
    nearest = &place;
  };
  for (const int p : used_entries(table))
    if (p != left_out) offer(table[p]);
  if (left_out != table.capacity()) offer(*scratch_);
  saved.hold_by(nearest->id, {nearest->q_WK, nearest->p_WK});
  return saved;
}

}  // namespace pf
