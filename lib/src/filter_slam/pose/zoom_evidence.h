#pragma once

#include "filter/filter.h"
#include "frame/pose_hypotheses.h"

namespace pf {

/// Adds to a consensus what the kept ones of these pixels say of the lens, from a pose near which they were taken. A depth that
/// is still open makes up for a lens that is too long: such a feature has its innovation's whole variance as noise, which is more than
/// that depth moves its pixel. Filter::begin_update must hold the same observations.
void weigh_lens(const Settings& settings, const Filter& filter, const PixelMeasurement* observations,
                const unsigned char* keep, int count, const Body& pose, PoseConsensus* consensus);

}  // namespace pf
