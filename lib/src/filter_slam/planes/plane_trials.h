#pragma once

#include "filter/filter.h"
#include "filter_slam/features/feature_keeper.h"
#include "filter_slam/planes/own_places.h"
#include "frame/settings.h"
#include "map/map.h"

/// Features that began on a plane, since their pixel shows what lies in its outline. Nothing else says yet that they lie there.

namespace pf {

/// Judges features that began on planes: accepts those as members whose own parallax shows that they lie there, drops those that it shows
/// elsewhere, or that were found elsewhere kTrialRejections times in a row. Their pixels are then free for a feature of open depth.
/// A dropped one counts as an outlier of the plane; a new member takes one of these back.
class PlaneTrials {
 public:
  PlaneTrials(const Settings& settings, const Filter& filter, Map& map, FeatureKeeper& features,
              const OwnPlaces& places)
      : settings_(settings), filter_(filter), map_(map), features_(features), places_(places) {}

  void judge();

 private:
  Scalar log_odds(int entry, int plane_entry) const;

  const Settings& settings_;
  const Filter& filter_;
  Map& map_;
  FeatureKeeper& features_;
  const OwnPlaces& places_;
};

}  // namespace pf
