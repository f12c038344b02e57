#include "keyframe_slam/map/covisible.h"

#include <algorithm>

#include "base/table_entries.h"

namespace pf {
namespace {

/// Points with a depth that a keyframe saw.
template <typename Use>
void for_each_point(const KeyframeMap& map, int keyframe, const Use& use) {
  const BundlePixel* pixels = map.keyframes.pixels(keyframe);
  for (int i = 0; i < map.capacity(); ++i)
    if (pixels[i].seen && map.used(i) && map.point(i).has_depth) use(i);
}

}  // namespace

int connected_keyframes(const KeyframeMap& map, int least, bool* connected, bool* scratch) {
  const KeyframeTable& keyframes = map.keyframes;
  std::fill(connected, connected + keyframes.capacity(), false);
  std::fill(scratch, scratch + map.capacity(), false);
  if (keyframes.newest() < 0) return 0;
  bool* seen = scratch;  // by those that are connected
  const auto add = [&](int k) {
    connected[k] = true;
    for_each_point(map, k, [&](int i) { seen[i] = true; });
  };
  add(keyframes.newest());
  int count = 1;
  for (bool grows = true; grows;) {
    grows = false;
    for (const int k : used_entries(keyframes)) {
      if (connected[k]) continue;
      int shared = 0;
      for_each_point(map, k, [&](int i) { shared += seen[i] ? 1 : 0; });
      if (shared < least) continue;
      add(k);
      ++count;
      grows = true;
    }
  }
  return count;
}

}  // namespace pf
