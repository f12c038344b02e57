#include "memory/returning_feature.h"

namespace pf {

void bring_back_feature(const KeptPlace& place, const PlacePoint& from, int entry, Map* map) {
  map->features.come_back(entry, from.id);
  Feature& f = map->features[entry];
  f.observations = f.attempts = from.observations;
  f.has_appearance = true;
  restore_patch(from.patch, &map->appearance(entry).patch);
  map->first_view(entry) = first_view_of(place, from);
}

}  // namespace pf
