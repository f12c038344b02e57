#pragma once

#include "keyframe_slam/map/keyframe_map.h"

/// Keyframes become places when they leave the window, and come back from there (lib/docs/places.md).

namespace pf {

/// What a keyframe saw of points whose depth is known: the most often observed ones, given the keyframe. False: too few of them for a
/// place; out is then of no use.
bool make_place(const KeyframeMap& map, int keyframe, KeptPlace* out);

class PlaceKeeper {
 public:
  PlaceKeeper(const Settings& settings, KeyframeMap& map, const Frame& frame)
      : settings_(settings), map_(map), frame_(frame) {}

  bool layout(Arena& arena) {
    if (settings_.kept.places > 0) scratch_ = arena.take<KeptPlace>(1);
    return arena.ok();
  }

  /// Keeps what a keyframe that is about to leave the window saw.
  void keep(int keyframe);
  /// Makes the place with this id a keyframe again. Those of its points that the window does not have any more become points of the window,
  /// with the depths that the place knows. A keyframe of the window is there already. False: there is no such place, or it gives way to the
  /// keyframe that would leave for it.
  bool bring_back(std::uint32_t id);

  /// Room for one place, within one call.
  KeptPlace* scratch() const { return scratch_; }

 private:
  void update(const KeptPlace& now, KeptPlace* kept) const;
  void bring_point(const KeptPlace& place, const PlacePoint& from, int keyframe);

  const Settings& settings_;
  KeyframeMap& map_;
  const Frame& frame_;
  KeptPlace* scratch_ = nullptr;
};

}  // namespace pf
