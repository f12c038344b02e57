#include "keyframe_slam/memory/keyframe_anchors.h"

#include "base/table_entries.h"
#include "memory/place.h"

namespace pf {

Status KeyframeAnchors::add(const AnchorRequest& asked, std::uint32_t map_id, const View& view, std::uint32_t* id) {
  const int entry = anchors_.find_free();
  if (entry < 0) return Status::kFull;
  Anchor anchor;
  anchor.map_id = map_id;
  anchor.t_ns = view.t_ns;
  anchor.T_VA = view.T_WV.inverse().of(asked.T_WA);
  if (asked.plane >= 0) {
    const PlaneFrame& frame = planes_.plane(asked.plane).frame;
    anchor.plane = map_.tables().planes[asked.plane].id;
    anchor.T_VA.q = upright_on(view.T_WV.q.conjugate() * frame.R_WP.col(2));
    HeldPose on;
    if (!project(map_.camera(), anchor.T_VA.p, &anchor.pixel) ||
        !held_pose_on(view.T_WV, anchor.T_VA, frame, Vec3::Zero(), &on))
      return Status::kRange;
  }
  // The pose is known against the map, and where that is known as its newest keyframe is, what this may be off comes with it.
  const Reference held_by = nearest(view.T_WV, view.depth);
  anchor.T_WV = view.T_WV;
  anchor.covariance_WV = view.covariance;
  if (held_by.covariance != view.covariance_of_map) anchor.covariance_WV += view.covariance_of_map;
  anchor.hold_by(held_by.id, held_by.T_WK);
  *id = anchors_.add(entry, anchor);
  place(view.depth, &anchors_[entry]);
  return Status::kOk;
}

void KeyframeAnchors::move(const RelativePlace& from_WC, const RelativePlace& to_WC, std::uint32_t map_id) {
  const Keyframe& newest = map_.keyframes[map_.keyframes.newest()];
  for (const int i : used_entries(anchors_)) {
    Anchor& anchor = anchors_[i];
    if (anchor.map_id != map_id) continue;
    anchor.leave_plane();
    anchor.T_WV = to_WC.of(from_WC.inverse().of(anchor.T_WV));
    anchor.hold_by(static_cast<std::uint32_t>(newest.number), {newest.q_WC, newest.p_W});
  }
}

void KeyframeAnchors::follow(std::uint32_t map_id, Scalar depth) {
  for (const int i : used_entries(anchors_))
    if (kHasMemory && anchors_[i].map_id == map_id) place(depth, &anchors_[i]);
}

void KeyframeAnchors::place(Scalar depth, Anchor* anchor) const {
  const PlaneTable& table = map_.tables().planes;
  Reference held_by;
  if (!find(anchor->place, &held_by)) {
    held_by = nearest(anchor->T_WV, depth);
    anchor->hold_by(held_by.id, held_by.T_WK);
  }
  const std::uint32_t now = anchor->plane != 0 ? table.find(anchor->plane) : 0;
  if (now == 0) {
    anchor->leave_plane();
    return place_by(held_by.T_WK, held_by.covariance, nullptr, anchor);
  }
  anchor->plane = now;
  const KeyframePlane& plane = planes_.plane(table.entry_of(now));
  const AnchorPlane lies_on = {plane.frame, Vec3::Zero(), plane.covariance};
  place_by(held_by.T_WK, held_by.covariance, &lies_on, anchor);
}

/// A keyframe of the window, or a place that is not in it; 0 is W.
bool KeyframeAnchors::find(std::uint32_t id, Reference* out) const {
  *out = Reference();
  out->id = id;
  if (id == 0) return true;
  for (const int k : used_entries(map_.keyframes)) {
    const Keyframe& keyframe = map_.keyframes[k];
    if (static_cast<std::uint32_t>(keyframe.number) != id) continue;
    *out = {id, {keyframe.q_WC, keyframe.p_W}, keyframe.covariance};
    return true;
  }
  const int p = map_.places.entry_of(id);
  if (p < 0 || !map_.places.is_present(p)) return false;
  const KeptPlace& kept = map_.places[p];
  *out = {id, {kept.q_WK, kept.p_WK}, kept.covariance};
  return true;
}

/// Of keyframes, and of places that are not in the window. Where there is neither, W itself.
KeyframeAnchors::Reference KeyframeAnchors::nearest(const RelativePlace& T_WV, Scalar depth) const {
  Reference best;
  Scalar least = 0;
  const auto offer = [&](const Reference& one, Scalar its_depth) {
    const Scalar d2 = view_distance2(T_WV.q, T_WV.p, depth, one.T_WK.q, one.T_WK.p, its_depth);
    if (best.id != 0 && !(d2 < least)) return;
    least = d2;
    best = one;
  };
  for (const int k : used_entries(map_.keyframes)) {
    const Keyframe& keyframe = map_.keyframes[k];
    offer({static_cast<std::uint32_t>(keyframe.number), {keyframe.q_WC, keyframe.p_W}, keyframe.covariance}, depth);
  }
  for (const int p : used_entries(map_.places)) {
    const KeptPlace& kept = map_.places[p];
    if (map_.places.is_present(p) && !kept.is_back)
      offer({kept.id, {kept.q_WK, kept.p_WK}, kept.covariance}, kept.depth);
  }
  return best;
}

}  // namespace pf
