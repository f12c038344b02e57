#include "geometry/carry.h"

#include "base/table_entries.h"
#include "keyframe_slam/planes/planes.h"

namespace pf {

void KeyframePlanes::carry(Archive& archive) {
  for (const int k : used_entries(table_)) {
    auto& [frame, covariance, adjusted] = plane_[k];
    pf::carry(archive, frame);
    archive.numbers(covariance);
    archive.flags(adjusted);
  }
  archive.numbers(viewer_W_);
  archive.any(searches_);
}

}  // namespace pf
