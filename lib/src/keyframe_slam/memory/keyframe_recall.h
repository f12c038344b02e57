#pragma once

#include "frame/pose_hypotheses.h"
#include "keyframe_slam/map/keyframe_map.h"
#include "memory/place_recall.h"

/// Which part of the map an image may show, by how its points look: places, and keyframes of the window (lib/docs/theory/places.md).

namespace pf {

class Archive;

class KeyframeRecall {
 public:
  KeyframeRecall(const Settings& settings, const KeyframeMap& map) : settings_(settings), map_(map) {}

  bool layout(Arena& arena);
  void init() { recall_.init(); }

  /// The place that most of the image agrees with, and as its rival the one that agrees most with another pose; its inliers are 0 where
  /// there is none. False: no place.
  bool find(const Tracker& tracker, Recalled* best, Recalled* rival);
  /// Describes the image of a tracked frame, for is_alike().
  void describe_image(const Tracker& tracker) { recall_.describe_image(tracker); }
  /// Whether the described image looks like another part of the map. view: its pose. median_depth: of what it sees.
  bool is_alike(const CameraView& view, Scalar median_depth);
  /// Where the described image looks like a place of another map, and no other place of those like it as much: the pose there, and points
  /// of that place with their pixels.
  bool find_other(Recalled* best, PlaceMatches* matches);

  void carry(Archive& archive);  ///< base/archive.h

 private:
  int sources() const;
  PlaceSource collect(int source, PlaceMatches* out) const;
  bool describe_point(int i, Descriptor* out) const;
  void match_window();

  const Settings& settings_;
  const KeyframeMap& map_;
  PlaceRecall recall_;
  std::int16_t* corner_ = nullptr;  ///< of each point of the window: what it may be in this image, -1: nothing
};

}  // namespace pf
