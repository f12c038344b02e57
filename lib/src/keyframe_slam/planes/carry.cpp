#include "geometry/carry.h"

#include "base/table_entries.h"
#include "keyframe_slam/planes/plane_upkeep.h"

namespace pf {

void KeyframePlanes::carry(Archive& archive) {
  for (const int k : used_entries(table_)) {
    auto& [frame, covariance, adjusted, plan] = plane_[k];
    pf::carry(archive, frame);
    archive.numbers(covariance);
    archive.flags(adjusted);
    pf::carry(archive, plan);
  }
}

void PlaneUpkeep::carry(Archive& archive) {
  archive.numbers(viewer_W_);
  archive.any(searches_);
}

}  // namespace pf
