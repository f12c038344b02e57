#include "keyframe_slam/memory/keyframe_recall.h"

#include "base/table_entries.h"
#include "frame/tuning.h"
#include "keyframe_slam/map/tuning.h"

namespace pf {

bool KeyframeRecall::layout(Arena& arena) {
  const bool is_asked_for = settings_.kept.places > 0;
  if (is_asked_for) corner_ = arena.take<std::int16_t>(static_cast<std::size_t>(settings_.max_features));
  return recall_.layout(arena, is_asked_for);
}

bool KeyframeRecall::find(const Tracker& tracker, Recalled* best, Recalled* rival) {
  *best = *rival = Recalled();
  if (settings_.kept.places == 0) return false;
  recall_.describe_image(tracker);
  match_window();
  const PlaceSearch& search = recall_.search();
  const int keyframes = map_.keyframes.capacity();
  const auto collect = [&](int i, PlaceMatches* out) {
    if (i < keyframes) {
      if (!map_.keyframes.used(i)) return PlaceSource();
      const BundlePixel* pixels = map_.keyframes.pixels(i);
      for (int p = 0; p < map_.capacity(); ++p)
        if (corner_[p] >= 0 && pixels[p].seen) out->add(map_.feature(p).id, map_.position(p), search.pixel(corner_[p]));
      const Keyframe& keyframe = map_.keyframes[i];
      return PlaceSource{static_cast<std::uint32_t>(keyframe.number), keyframe.q_WC, keyframe.p_W};
    }
    const int p = i - keyframes;
    if (!map_.places.used(p) || map_.places[p].is_back) return PlaceSource();
    collect_place(search, map_.places, p, out);
    return PlaceSource{map_.places[p].id, map_.places[p].q_WK, map_.places[p].p_WK};
  };
  return recall_.find(map_.camera(), keyframes + map_.places.capacity(), tuning::relocaliser::kAboutView, collect, best,
                      rival);
}

void KeyframeRecall::match_window() {
  for (int i = 0; i < map_.capacity(); ++i) {
    corner_[i] = -1;
    if (!map_.used(i) || !map_.point(i).has_depth || !map_.feature(i).has_appearance) continue;
    Descriptor descriptor;
    if (describe(map_.tables().appearance(i).patch, &descriptor))
      corner_[i] = static_cast<std::int16_t>(recall_.search().corner_of(descriptor));
  }
}

}  // namespace pf
