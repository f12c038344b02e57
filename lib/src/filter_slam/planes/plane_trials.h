#pragma once

#include "filter/filter.h"
#include "filter_slam/features/feature_keeper.h"
#include "filter_slam/planes/own_places.h"
#include "frame/settings.h"
#include "map/map.h"

/// Features that began on a plane, since their pixel shows what lies in its outline. Nothing else says yet that they lie there.

namespace pf {

/// ln p(s | on the plane) / p(s | somewhere along the ray), of what a feature's own pixels say of its depth (own_places.h):
///
///   on the plane   s ~ N(0, v + t²)       v  variance of s;  t  sigma of the plane's own place along the ray, with its roughness
///   somewhere      s ~ N(0, v + w²)       w  sigma of a depth of which nothing is known
///
/// Without parallax v is large against both, and the two explain s equally well: 0.
Scalar log_odds_of_depth(Scalar s, Scalar v, Scalar t, Scalar w);

/// Judges features that began on planes: believes those whose own parallax shows that they lie there, and drops those that it shows
/// elsewhere, or that were found elsewhere kTrialRejections times in a row. Their pixels are then free for a feature of open depth.
/// What is elsewhere counts as an outlier of the plane; what is believed takes one of these back.
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
