#pragma once

#include "filter/filter.h"
#include "map/map.h"
#include "slam/frame.h"
#include "slam/settings.h"
#include "slam/tracking_state.h"

/// Takes a frame's pixels into the filter: what is expected of them, the update, and its second round.

namespace pf {

/// A feature that this frame measures. Its prediction and pixel are the observation of the same index.
struct Candidate {
  int feature;  ///< entry of the feature table
  int match;    ///< index in the frame's matches
};

class PixelUpdate {
 public:
  PixelUpdate(const Settings& settings, Filter& filter, Map& map, Frame& frame, TrackingState& tracking)
      : settings_(settings), filter_(filter), map_(map), frame_(frame), tracking_(tracking) {}

  bool layout(Arena& arena, int max_observations);

  /// max_observations each. What is kept is taken in.
  Candidate& candidate(int i) { return candidate_[i]; }
  const Candidate& candidate(int i) const { return candidate_[i]; }
  PixelMeasurement& observation(int i) { return observation_[i]; }
  const PixelMeasurement* observations() const { return observation_; }
  unsigned char* keep() { return keep_; }

  /// A candidate and its observation move to another index.
  void move(int from, int to) {
    candidate_[to] = candidate_[from];
    observation_[to] = observation_[from];
  }

  /// H P H^T of a predicted pixel; adds to its second-order noise what the projection bends over the spread of the pose.
  Mat2 expected_innovation(PixelMeasurement* o) const;
  /// Gathers H P H^T of `count` observations from `first` on.
  void begin(int first, int count);
  /// Takes in the kept ones of those that begin() gathered. False when nothing was taken in.
  bool apply(int first, int count);

 private:
  void relinearise_update(int first, int count);

  const Settings& settings_;
  Filter& filter_;
  Map& map_;
  Frame& frame_;
  TrackingState& tracking_;
  Candidate* candidate_ = nullptr;
  PixelMeasurement* observation_ = nullptr;
  unsigned char* keep_ = nullptr;
};

}  // namespace pf
