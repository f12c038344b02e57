#pragma once

#include "filter/filter.h"
#include "frame/start/start.h"
#include "frame/start/start_without_target.h"
#include "map/map.h"

/// Compares the filter's first depths with those of the record beside it (lib/docs/theory/starting.md, lib/docs/theory/walls.md).

namespace pf {

/// W's lengths per length of the record: the ratio of the sums of distances of the target's points. Zero where the bundle has none of them.
Scalar unit_by_target(const Map& map, const Target& target, const StartWithoutTarget& record);

/// W's lengths per length of the record, such that most of its points that are seen before walls of the plan lie on them: the most common
/// ratio of the two distances. Other points lie before the wall, or the wall is not there. Zero where no ratio has a clear majority.
Scalar unit_by_walls(const Filter& filter, const Map& map, const StartWithoutTarget& record);

/// Whether for most features filter and record have about the same distance from the first frame.
bool depths_agree(const Filter& filter, const Map& map, const StartWithoutTarget& record, Scalar unit);

/// Whether the filter has moved from the record's first frame to here as the record has: a scene turned inside out is seen from a camera
/// that moves the other way, while many depths are hardly different.
bool motion_agrees(const Filter& filter, const StartWithoutTarget& record, Scalar unit);

}  // namespace pf
