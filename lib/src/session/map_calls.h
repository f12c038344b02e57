#pragma once

#include <cstdint>

#include "base/status.h"
#include "frame/settings.h"
#include "map/map.h"
#include "memory/map_bytes.h"

/// Calls of the API that change the map without an image: a saved map that is begun in, and anchors.

namespace pf {

class FilterSlam;
class KeyframeSlam;

class MapCalls {
 public:
  /// One of the two back ends is null.
  MapCalls(const Settings& settings, Map& map, FilterSlam* filter, KeyframeSlam* window)
      : settings_(settings), map_(map), filter_(filter), window_(window) {}

  /// Begins in a saved map, before the first frame. kState: with the filter, or something else has begun. wrong: what is wrong with it,
  /// where it is kMap. gravity_W: of the map; zero: not known.
  Status load(const std::uint8_t* buffer, std::size_t bytes, const char** wrong, Vec3* gravity_W);
  /// Sets an anchor from the camera of the last frame. kState: it is not tracked. kFull, kRange: FilterAnchors::add, KeyframeAnchors::add.
  Status add_anchor(const AnchorRequest& asked, std::uint32_t* id);
  /// kNothing: there is no such anchor.
  Status remove_anchor(std::uint32_t id);

 private:
  const Settings& settings_;
  Map& map_;
  FilterSlam* filter_;
  KeyframeSlam* window_;
};

}  // namespace pf
