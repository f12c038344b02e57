#pragma once

#include "frame/pose_hypotheses.h"
#include "keyframe_slam/map/keyframe_map.h"
#include "memory/place_search.h"

/// Which part of the map an image may show, by how its points look: places, and keyframes of the window (lib/docs/theory/places.md).

namespace pf {

/// Where the camera may be, by one place.
struct Recall {
  PoseHypothesis pose;
  std::uint32_t place = 0;  ///< id; of a keyframe of the window its number
  Scalar depth = 1;         ///< of what is seen, median
  int inliers = 0;
};

class PlaceRecall {
 public:
  PlaceRecall(const Settings& settings, const KeyframeMap& map) : settings_(settings), map_(map) {}

  bool layout(Arena& arena);
  void init() { search_.init(); }

  /// The place that most of the image agrees with, and as its rival the one that agrees most with another pose; its inliers are 0 where
  /// there is none. False: no place.
  bool find(const Tracker& tracker, Recall* best, Recall* rival);

 private:
  /// A place or a keyframe whose points may be in the image.
  struct Candidate {
    int place = -1, keyframe = -1;
    int matches = 0;
  };
  static constexpr int kMaxCandidates = 3;

  void match_window();
  void list(Candidate* candidate);
  int collect(const Candidate& candidate, PlaceMatches* out) const;
  void add_points(const KeptPlace& place, PlaceMatches* out) const;
  bool try_candidate(const Candidate& candidate, Recall* out);
  bool is_apart(const Recall& a, const Recall& b) const;

  const Settings& settings_;
  const KeyframeMap& map_;
  PlaceSearch search_;
  std::int16_t* corner_ = nullptr;  ///< of each point of the window: what it may be in this image, -1: nothing
};

}  // namespace pf
