#include "frame/kept/carry.h"

#include "filter_slam/pose/proposed_poses.h"

namespace pf {

void ProposedPoses::carry(Archive& archive) {
  pf::carry(archive, last_);
  pf::carry(archive, now_);
  archive.any(dt_ns_);
}

}  // namespace pf
