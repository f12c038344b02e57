#include "filter_slam/memory/filter_memory.h"

#include "base/table_entries.h"
#include "frame/tuning.h"

namespace pf {

bool FilterMemory::layout(Arena& arena) {
  places_.layout(arena);
  recall_.layout(arena, settings_.kept.places);
  scratch_ = arena.take<KeptPlace>(1);
  record_ = arena.take<PlaneRecord>(static_cast<std::size_t>(settings_.max_planes));
  return arena.ok();
}

void FilterMemory::init() {
  places_.init();
  maker_.init();
  recall_.init();
  rivals_.init();
  clear();
}

void FilterMemory::clear() {
  places_.clear();
  maker_.drop();
  for (int k = 0; k < settings_.max_planes; ++k) record_[k] = PlaneRecord();
  is_loaded_ = is_found_ = is_recalled_ = recalled_in_vain_ = false;
}

Status FilterMemory::load(const SavedMap& saved, std::uint32_t map_id) {
  constexpr int kPlaneRows = 3;
  if (saved.num_places() > settings_.kept.places || saved.num_planes() > settings_.max_planes ||
      saved.num_anchors() > settings_.kept.anchors || kPlaneRows * saved.num_planes() > filter_.room())
    return Status::kFull;
  clear();
  // No record holds the correlation between planes and places (StatePlaces): half of the weights for each.
  const Scalar planes = static_cast<Scalar>(saved.num_planes());
  const Scalar parts = planes > Scalar(0) ? Scalar(2) : Scalar(1);
  saved.for_each_plane([&](const SavedPlane& plane) { restore_plane(plane, parts * planes); });
  saved.for_each_place(scratch_, [&](const KeptPlace& place) { places_.table().keep(place); });
  saved.for_each_anchor([&](const Anchor& anchor) { restore_anchor(anchor, map_id); });
  places_.share(parts);
  places_.follow_up_to(saved.last_place());
  maker_.number_from(saved.last_place());
  map_.features.reserve_ids(saved.last_feature());
  is_loaded_ = true;
  return Status::kOk;
}

void FilterMemory::restore_plane(const SavedPlane& plane, Scalar parts) {
  const int entry = map_.planes.restore(plane.id);
  PlaneEntry& restored = map_.planes[entry];
  restored.slot = filter_.add_known_plane(plane.frame, parts * plane.covariance, settings_.fold.roughness);
  filter_.set_owner(restored.slot, entry);
  restored.max_points = static_cast<int>(plane.max_points);
  restored.seen = restored.support = plane.outline;
  record_[entry] = {plane.id, plane.covariance};
}

/// It stays where its place has it until that enters the state.
void FilterMemory::restore_anchor(const Anchor& anchor, std::uint32_t map_id) {
  const int entry = map_.anchors.find_free();
  map_.anchors.restore(entry, anchor);
  Anchor& restored = map_.anchors[entry];
  restored.map_id = map_id;
  restored.t_ns = INT64_MIN;  // no anchor that is set later shares what holds it
  RelativePlace T_WK;
  Mat6 covariance = Mat6::Zero();
  const int place = places_.table().entry_of(anchor.place);
  if (place >= 0) {
    const KeptPlace& kept = places_.table()[place];
    T_WK = {kept.q_WK, kept.p_WK};
    covariance = kept.covariance;
  }
  const int plane = map_.planes.entry_of(anchor.plane);
  if (plane < 0) return place_by(T_WK, covariance, nullptr, &restored);
  const Block& block = filter_.state().block[map_.planes[plane].slot];
  const AnchorPlane on = {filter_.state().frame_of(block), block.xyz(), record_[plane].covariance};
  place_by(T_WK, covariance, &on, &restored);
}

bool FilterMemory::recall(const Tracker& tracker, PoseHypothesis* place, PoseHypothesis* rival, bool* has_rival) {
  places_.end_trial();
  is_recalled_ = false;
  if (recalled_in_vain_) return recalled_in_vain_ = false;  // now the kept views are tried
  const PlaceTable& table = places_.table();
  if (!is_loaded_ || table.count() == 0) return false;
  recall_.describe_image(tracker);
  recall_.match_places(table);
  const auto collect = [&](int p, PlaceMatches* out) {
    if (!table.used(p)) return PlaceSource();
    recall_.collect_place(table, p, out);
    return PlaceSource{table[p].id, table[p].q_WK, table[p].p_WK};
  };
  Recalled best, other;
  if (!recall_.find(filter_.lens(), table.capacity(), tuning::relocaliser::kAboutView, collect, &best, &other))
    return false;
  const CameraView view = {best.pose.q_WC, best.pose.p_WC};
  if (!places_.try_place(table.entry_of(best.place), view)) return false;
  *has_rival =
      other.inliers > 0 && places_.try_place(table.entry_of(other.place), CameraView{other.pose.q_WC, other.pose.p_WC});
  places_.try_near(view, best.depth);
  *place = PoseHypothesis::of(best.pose);
  *rival = PoseHypothesis::of(other.pose);
  depth_ = best.depth;
  return is_recalled_ = true;
}

void FilterMemory::follow(const CameraView& view, Scalar depth) {
  if (is_loaded_ && !is_found_) depth = depth_;
  is_found_ = true;
  places_.follow(view, depth);
  maker_.follow(view, depth, scratch_);
}

}  // namespace pf
