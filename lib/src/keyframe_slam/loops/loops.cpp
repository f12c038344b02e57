#include "keyframe_slam/loops/loops.h"

#include "keyframe_slam/map/tuning.h"

namespace pf {

bool Loops::layout(Arena& arena) {
  const int places = static_cast<int>(settings_.kept.places);
  chain_.layout(arena, places > 0 ? places + tuning::keyframe_map::kKeyframes : 0);
  finder_.layout(arena);
  return return_.layout(arena);
}

/// A place has the number of the keyframe that it was.
void Loops::add_keyframe(const KeyframeAdjustment& adjustment) {
  if (settings_.kept.places == 0) return;
  chain_.keep_only([&](int number) {
    const int place = map_.places.entry_of(static_cast<std::uint32_t>(number));
    return map_.keyframes.entry_of(number) >= 0 || (place >= 0 && map_.places.is_present(place));
  });
  const Keyframe& newest = map_.keyframes[map_.keyframes.newest()];
  const AdjustmentShape& shape = adjustment.shape();
  chain_.add(newest.number, shape.is_determined ? shape.hangs_on : 0, adjustment.drift(), newest.p_W);
}

void Loops::carry(Archive& archive) {
  chain_.carry(archive);
  finder_.carry(archive);
}

}  // namespace pf
