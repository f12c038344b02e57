#include "memory/returning_feature.h"

namespace pf {

void bring_back_feature(const KeptPlace& place, const PlacePoint& from, int entry, Map* map) {
  map->features.come_back(entry, from.id);
  Feature& f = map->features[entry];
  f.observations = f.attempts = from.observations;
  f.has_appearance = true;
  restore_patch(from.patch, &map->appearance(entry).patch);
  const auto number = [](float x) { return static_cast<Scalar>(x); };
  const Quat q_KV(number(from.q_KV[0]), number(from.q_KV[1]), number(from.q_KV[2]), number(from.q_KV[3]));
  const Vec3 c_K(number(from.c_K[0]), number(from.c_K[1]), number(from.c_K[2]));
  map->first_view(entry) = {(place.q_WK * q_KV).normalized(), place.p_WK + place.q_WK * c_K};
}

}  // namespace pf
