#pragma once

#include "keyframe_slam/map/keyframe_map.h"

/// Keyframes become places when they leave the window, and come back from there (lib/docs/theory/places.md).

namespace pf {

/// What a keyframe saw of points whose depth is known, given the keyframe: the most often observed ones of those that no other place has,
/// and of the others as many as a place needs. taken: of each point of the window, whether another place has it; null: none is. False: too
/// few points for a place; out is then of no use.
bool make_place(const KeyframeMap& map, int keyframe, const bool* taken, KeptPlace* out);
/// Marks the points of the window that a place has.
void mark_taken(const KeyframeMap& map, const KeptPlace& place, bool* taken);

class PlaceKeeper {
 public:
  PlaceKeeper(const Settings& settings, KeyframeMap& map) : settings_(settings), map_(map) {}

  bool layout(Arena& arena) {
    if (settings_.kept.places == 0) return arena.ok();
    scratch_ = arena.take<KeptPlace>(1);
    taken_ = arena.take<bool>(static_cast<std::size_t>(settings_.max_features));
    return arena.ok();
  }

  /// Keeps what a keyframe that is about to leave the window saw.
  void keep(int keyframe);
  /// Makes the place with this id a keyframe again. Those of its points that the window does not have any more become points of the window,
  /// with the depths that the place knows. A keyframe of the window is there already. False: there is no such place, or it gives way to the
  /// keyframe that would leave for it.
  bool bring_back(std::uint32_t id);

  /// Places whose keyframes are in the window are where these are now.
  void follow_keyframes();
  /// The points of a place whose keyframe is in the window come back to it, as far as they have left it.
  void bring_points(std::uint32_t id);

  /// Brings the places back that see much of what a view sees, the nearest first, as far as they are not in the window: at most so many.
  void bring_near(const CameraView& view, Scalar depth, int most);

  /// Room within one call: for one place, and for a mark on each point of the window.
  KeptPlace* scratch() const { return scratch_; }
  bool* taken() const { return taken_; }

 private:
  void update(const KeptPlace& now, KeptPlace* kept) const;
  void bring_point(const KeptPlace& place, const PlacePoint& from, int keyframe);

  const Settings& settings_;
  KeyframeMap& map_;
  KeptPlace* scratch_ = nullptr;
  bool* taken_ = nullptr;
};

}  // namespace pf
