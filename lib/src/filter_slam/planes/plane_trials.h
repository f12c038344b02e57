#pragma once

#include "filter/filter.h"
#include "filter_slam/features/feature_keeper.h"
#include "frame/frame.h"
#include "map/map.h"

namespace pf {

/// Judges features that began on a plane: believes those that were found there kTrialMatches times and from where another depth would
/// show; drops those that were found elsewhere kTrialRejections times in a row, or where another depth puts them. Their pixels are then
/// free for a feature of open depth.
void judge_trials(const Filter& filter, Map& map, const Frame& frame, FeatureKeeper& features);

}  // namespace pf
