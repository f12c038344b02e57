#pragma once

#include <cstdint>

#include "belief/pose_evidence.h"
#include "filter/filter.h"
#include "filter_slam/features/feature_keeper.h"
#include "filter_slam/pose/pixel_update.h"
#include "frame/frame.h"
#include "frame/settings.h"
#include "map/given_pixels.h"
#include "map/map.h"

/// Measures a frame of pixels that the caller has matched: gates them, updates the filter, and adds features for unknown ids.

namespace pf {

class ObservationFrontEnd {
 public:
  ObservationFrontEnd(const Settings& settings, Filter& filter, Map& map, Frame& frame, FeatureKeeper& features,
                      PixelUpdate& update)
      : settings_(settings), filter_(filter), map_(map), frame_(frame), features_(features), update_(update) {}

  bool layout(Arena& arena, int max_features, int max_observations);

  /// Buffer for the observations of a frame; as large as the map and a frame together.
  PixelObservation* inbox() { return inbox_; }
  int inbox_size() const { return settings_.max_features + settings_.max_observations; }

  /// Updates the filter with observations of the map's features. again: of the same frame once more, which is not counted twice.
  UpdateOutcome measure(const PixelObservation* observations, int count, bool again, const UpdateMode& mode);
  /// Counts the observations and updates the log-odds of their features. mean: of earlier frames.
  void count(const FindShare& mean);
  /// Adds features for observations with unknown ids.
  void add_features(const PixelObservation* observations, int count);

 private:
  int gate(const PixelObservation* observations, int count, bool again);
  int find(std::uint32_t external_id) const;

  const Settings& settings_;
  Filter& filter_;
  Map& map_;
  Frame& frame_;
  FeatureKeeper& features_;
  PixelUpdate& update_;
  unsigned char* seen_ = nullptr;  ///< max_features: observed in this frame, and counted
  PixelObservation* inbox_ = nullptr;
};

}  // namespace pf
