#pragma once

#include "map/map.h"
#include "memory/place.h"

namespace pf {

/// A new entry of the map becomes the feature of a place's point again: its id, appearance and first view.
void bring_back_feature(const KeptPlace& place, const PlacePoint& from, int entry, Map* map);

}  // namespace pf
