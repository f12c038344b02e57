#include "slam/window_covisible.h"

#include <algorithm>

#include "window/tuning.h"

namespace pf {

int shared_points(const WindowMap& map, int a, int b) {
  const BundlePixel* in_a = map.keyframes.pixels(a);
  const BundlePixel* in_b = map.keyframes.pixels(b);
  int shared = 0;
  for (int i = 0; i < map.capacity(); ++i)
    shared += in_a[i].seen && in_b[i].seen && map.used(i) && map.point(i).has_depth ? 1 : 0;
  return shared;
}

int connected_keyframes(const WindowMap& map, int least, bool* connected) {
  const KeyframeTable& keyframes = map.keyframes;
  std::fill(connected, connected + keyframes.capacity(), false);
  if (keyframes.newest() < 0) return 0;
  int reached[tuning::window_map::kKeyframes] = {keyframes.newest()};
  int count = 1;
  connected[keyframes.newest()] = true;
  for (int at = 0; at < count; ++at)
    for (int k = 0; k < keyframes.capacity(); ++k) {
      if (!keyframes.used(k) || connected[k] || shared_points(map, reached[at], k) < least) continue;
      connected[k] = true;
      reached[count++] = k;
    }
  return count;
}

}  // namespace pf
