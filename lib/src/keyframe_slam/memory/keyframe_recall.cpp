#include "keyframe_slam/memory/keyframe_recall.h"

#include "base/table_entries.h"
#include "frame/tuning.h"
#include "keyframe_slam/map/tuning.h"
#include "memory/tuning.h"

namespace pf {

bool KeyframeRecall::layout(Arena& arena) {
  const bool is_asked_for = settings_.kept.places > 0;
  if (is_asked_for) corner_ = arena.take<std::int16_t>(static_cast<std::size_t>(settings_.max_features));
  return recall_.layout(arena, settings_.kept.places);
}

bool KeyframeRecall::find(const Tracker& tracker, Recalled* best, Recalled* rival) {
  *best = *rival = Recalled();
  if (settings_.kept.places == 0) return false;
  recall_.describe_image(tracker);
  recall_.match_places(map_.places);
  match_window();
  return recall_.find(
      map_.camera(), sources(), tuning::relocaliser::kAboutView,
      [&](int i, PlaceMatches* out) { return collect(i, out); }, best, rival);
}

bool KeyframeRecall::is_alike(const CameraView& view, Scalar median_depth) {
  recall_.match_places(map_.places);
  match_window();
  Recalled at;
  at.pose.q_WC = view.q_WC;
  at.pose.p_WC = view.c_W;
  at.depth = median_depth;
  return recall_.is_alike(map_.camera(), sources(), at, [&](int i, PlaceMatches* out) { return collect(i, out); });
}

bool KeyframeRecall::find_other(Recalled* best, PlaceMatches* matches) {
  Recalled rival;
  recall_.match_places(map_.places);
  const auto collect_other = [&](int p, PlaceMatches* out) {
    if (!map_.places.used(p) || map_.places.is_present(p)) return PlaceSource();
    recall_.collect_place(map_.places, p, out);
    return PlaceSource{map_.places[p].id, map_.places[p].q_WK, map_.places[p].p_WK};
  };
  if (!recall_.find(map_.camera(), map_.places.capacity(), tuning::relocaliser::kAboutView, collect_other, best,
                    &rival))
    return false;
  if (best->inliers < tuning::map_join::kRival * rival.inliers) return false;
  *matches = PlaceMatches();
  recall_.collect_place(map_.places, map_.places.entry_of(best->place), matches);
  return true;
}

/// Keyframes, and behind them places.
int KeyframeRecall::sources() const { return map_.keyframes.capacity() + map_.places.capacity(); }

PlaceSource KeyframeRecall::collect(int i, PlaceMatches* out) const {
  const int keyframes = map_.keyframes.capacity();
  if (i < keyframes) {
    if (!map_.keyframes.used(i)) return PlaceSource();
    const BundlePixel* pixels = map_.keyframes.pixels(i);
    for (int p = 0; p < map_.capacity(); ++p)
      if (corner_[p] >= 0 && pixels[p].seen)
        out->add(map_.feature(p).id, map_.position(p), recall_.search().pixel(corner_[p]));
    const Keyframe& keyframe = map_.keyframes[i];
    return {static_cast<std::uint32_t>(keyframe.number), keyframe.q_WC, keyframe.p_W};
  }
  const int p = i - keyframes;
  if (!map_.places.is_present(p) || map_.places[p].is_back) return PlaceSource();
  recall_.collect_place(map_.places, p, out);
  return {map_.places[p].id, map_.places[p].q_WK, map_.places[p].p_WK};
}

/// Of a point that can be compared with others: it has a place, and an image.
bool KeyframeRecall::describe_point(int i, Descriptor* out) const {
  return map_.used(i) && map_.point(i).has_depth && map_.feature(i).has_appearance &&
         describe(map_.tables().appearance(i).patch, out);
}

void KeyframeRecall::match_window() {
  for (int i = 0; i < map_.capacity(); ++i) {
    corner_[i] = -1;
    Descriptor descriptor;
    if (describe_point(i, &descriptor)) corner_[i] = static_cast<std::int16_t>(recall_.search().corner_of(descriptor));
  }
}

}  // namespace pf
