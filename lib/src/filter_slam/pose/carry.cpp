#include "frame/kept/carry.h"

#include "filter_slam/pose/body_motion.h"
#include "filter_slam/pose/proposed_poses.h"

namespace pf {

void UnitNoise::carry(Archive& archive) {
  auto& [last_ns, second, third, count, white, excess] = data_;
  archive.any(last_ns);
  archive.counts(count);
  archive.numbers(second, third, white, excess);
}

void BodyMotion::carry(Archive& archive) {
  auto& [given, dv_C, dw_C] = data_;
  archive.flags(given);
  archive.numbers(dv_C, dw_C);
  noise_.carry(archive);
}

void ProposedPoses::carry(Archive& archive) {
  pf::carry(archive, last_);
  pf::carry(archive, now_);
  archive.any(dt_ns_);
}

}  // namespace pf
