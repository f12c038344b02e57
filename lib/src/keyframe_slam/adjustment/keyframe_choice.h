#pragma once

#include "keyframe_slam/adjustment/keyframe_bundle.h"

/// Chooses the keyframes and points of an adjustment.

namespace pf {

class Archive;

/// Most keyframes that are adjusted at once.
int max_free_keyframes(const Settings& settings);

class KeyframeChoice {
 public:
  KeyframeChoice(const Settings& settings, const KeyframeMap& map) : settings_(settings), map_(map) {}

  bool layout(Arena& arena);

  /// Keyframes that are adjusted, points that they see, and keyframes that see these points and are held fixed. settled: as for
  /// KeyframeAdjustment::run. False: too few.
  bool choose(bool settled, AdjustedPoses* poses, AdjustedPoints* points);

  // Of the last choice.
  /// The map's first keyframe is not connected with the newest one.
  bool is_away() const { return is_away_; }
  /// At least two of the connected keyframes see points of the target, which then holds the map where it is.
  bool is_held_by_target() const { return is_held_by_target_; }
  /// All but one of many keyframes are adjusted, and neither other keyframes nor the target hold the scale.
  bool needs_distance(const AdjustedPoses& poses) const;

  void carry(Archive& archive);  ///< base/archive.h

 private:
  void connect(bool settled);
  bool has_first_keyframe() const;
  bool sees_target(int keyframe) const;
  int num_held(bool settled) const;
  void choose_free(bool settled, AdjustedPoses* poses) const;
  void choose_points(const AdjustedPoses& poses, AdjustedPoints* points) const;
  void choose_fixed(const AdjustedPoints& points, int max_fixed, AdjustedPoses* poses) const;

  const Settings& settings_;
  const KeyframeMap& map_;
  bool* is_connected_ = nullptr;  ///< keyframes, with the newest one by points that they share
  bool* is_seen_ = nullptr;       ///< points, by one of them
  int connected_ = 0;
  bool is_away_ = false;
  bool is_held_by_target_ = false;
};

}  // namespace pf
