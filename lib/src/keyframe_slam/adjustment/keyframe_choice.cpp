#include "keyframe_slam/adjustment/keyframe_choice.h"

#include <algorithm>

#include "base/table_entries.h"
#include "keyframe_slam/adjustment/tuning.h"
#include "keyframe_slam/map/covisible.h"
#include "keyframe_slam/map/tuning.h"

namespace pf {

using namespace tuning::keyframe_adjustment;

int max_free_keyframes(const Settings& settings) {
  const int keyframes = tuning::keyframe_map::kKeyframes;
  return settings.lens.rows.count > 0 ? keyframes : keyframes - kHeldKeyframes;
}

bool KeyframeChoice::layout(Arena& arena) {
  is_connected_ = arena.take<bool>(static_cast<std::size_t>(tuning::keyframe_map::kKeyframes));
  is_seen_ = arena.take<bool>(static_cast<std::size_t>(settings_.max_features));
  return arena.ok();
}

bool KeyframeChoice::choose(bool settled, AdjustedPoses* poses, AdjustedPoints* points) {
  connect(settled);
  choose_free(settled, poses);
  if (poses->free < 1) return false;
  choose_points(*poses, points);
  if (points->seen < kMinPoints) return false;
  choose_fixed(*points, settled ? kHeldAway : static_cast<int>(settings_.window_fixed), poses);
  return true;
}

/// Which keyframes are connected with the newest one; all, where these are too few.
void KeyframeChoice::connect(bool settled) {
  const KeyframeTable& keyframes = map_.keyframes;
  connected_ = settled ? connected_keyframes(map_, kMinShared, is_connected_, is_seen_) : 0;
  if (connected_ < kMinConnected) {
    for (int k = 0; k < keyframes.capacity(); ++k) is_connected_[k] = keyframes.used(k);
    connected_ = keyframes.count();
  }
  is_away_ = settled && !has_first_keyframe();
  int with_target = 0;
  for (int k = 0; k < keyframes.capacity(); ++k) with_target += is_connected_[k] && sees_target(k) ? 1 : 0;
  is_held_by_target_ = with_target > 1;
}

bool KeyframeChoice::has_first_keyframe() const {
  for (int k = 0; k < map_.keyframes.capacity(); ++k)
    if (is_connected_[k] && map_.keyframes.is_first(k)) return true;
  return false;
}

bool KeyframeChoice::sees_target(int keyframe) const {
  int seen = 0;
  for (int i = 0; i < map_.capacity(); ++i)
    seen += map_.used(i) && map_.feature(i).is_target && map_.keyframes.pixels(keyframe)[i].seen ? 1 : 0;
  return seen >= kMinTargetPoints;
}

/// How many of the connected keyframes are not adjusted. Of few, one, unless the target holds them; of more, the oldest three. Where the
/// lens is uncertain, always one: fixed keyframes would hold the lens to the one that they were adjusted with. Away from the first
/// keyframe, the oldest six, since one keyframe and a distance would force their own errors on all others.
int KeyframeChoice::num_held(bool settled) const {
  if (is_held_by_target_) return 0;
  if (is_away_ && connected_ >= kMinPerHeld * kHeldAway) return kHeldAway;
  if (settled && settings_.lens.rows.count == 0 && connected_ >= kMinPerHeld * kHeldKeyframes) return kHeldKeyframes;
  return 1;
}

/// The newest of the connected keyframes, the oldest of these first.
void KeyframeChoice::choose_free(bool settled, AdjustedPoses* poses) const {
  const KeyframeTable& keyframes = map_.keyframes;
  const int most = settled ? max_free_keyframes(settings_) : static_cast<int>(settings_.window_keyframes);
  poses->free = std::min(most, connected_ - num_held(settled));
  for (int c = 0; c < poses->free; ++c) {
    // The (free - c)-th newest.
    int at = -1;
    for (int k = 0; k < keyframes.capacity(); ++k) {
      if (!is_connected_[k]) continue;
      int newer = 0;
      for (int other = 0; other < keyframes.capacity(); ++other)
        newer += is_connected_[other] && keyframes[other].number > keyframes[k].number ? 1 : 0;
      if (newer == poses->free - 1 - c) at = k;
    }
    poses->keyframe[c] = at;
  }
}

/// Points with a depth that a free keyframe sees, and another one.
void KeyframeChoice::choose_points(const AdjustedPoses& poses, AdjustedPoints* points) const {
  points->seen = 0;
  for (const int i : used_entries(map_)) {
    if (!map_.point(i).has_depth) continue;
    int in_free = 0, in_all = 0;
    for (int c = 0; c < poses.free; ++c) in_free += map_.keyframes.pixels(poses.keyframe[c])[i].seen ? 1 : 0;
    for (int k = 0; k < map_.keyframes.capacity(); ++k)
      in_all += map_.keyframes.used(k) && map_.keyframes.pixels(k)[i].seen ? 1 : 0;
    if (in_free > 0 && in_all > 1) points->row[points->seen++] = static_cast<std::int16_t>(i);
  }
  points->count = points->seen;
}

/// The other keyframes that see most of these points, the older one among equals.
void KeyframeChoice::choose_fixed(const AdjustedPoints& points, int max_fixed, AdjustedPoses* poses) const {
  poses->seen_in = poses->free;
  for (int f = 0; f < max_fixed; ++f) {
    int best = -1, most = kMinShared - 1;
    for (int k = 0; k < map_.keyframes.capacity(); ++k) {
      const int* end = poses->keyframe + poses->seen_in;
      if (!map_.keyframes.used(k) || std::find<const int*>(poses->keyframe, end, k) != end) continue;
      int seen = 0;
      for (int p = 0; p < points.seen; ++p) seen += map_.keyframes.pixels(k)[points.row[p]].seen ? 1 : 0;
      if (seen < most || (seen == most && (best < 0 || map_.keyframes[k].number < map_.keyframes[best].number)))
        continue;
      best = k;
      most = seen;
    }
    if (best < 0) break;
    poses->keyframe[poses->seen_in++] = best;
  }
}

bool KeyframeChoice::needs_distance(const AdjustedPoses& poses) const {
  return poses.seen_in == poses.free + 1 && !is_held_by_target_ && connected_ >= kMinPerHeld * kHeldKeyframes;
}

}  // namespace pf
