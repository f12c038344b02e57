#include "map/given_pixels.h"

#include "base/table_entries.h"

namespace pf {

bool GivenPixels::layout(Arena& arena, int max_features, int room) {
  inbox_ = arena.take<PixelObservation>(static_cast<std::size_t>(room));
  at_ = arena.take<std::int16_t>(static_cast<std::size_t>(max_features));
  return arena.ok();
}

void GivenPixels::begin(int count, const FeatureTable& features) {
  are_given_ = true;
  count_ = count;
  for (int i = 0; i < features.capacity(); ++i) at_[i] = -1;
  for (const int i : used_entries(features))
    for (int k = 0; k < count && at_[i] < 0; ++k)
      if (inbox_[k].external_id == features[i].external_id) at_[i] = static_cast<std::int16_t>(k);
}

}  // namespace pf
