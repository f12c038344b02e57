#include "frame/start/carry.h"

#include "keyframe_slam/adjustment/keyframe_adjustment.h"
#include "vision/carry.h"

namespace pf {

void HeldTarget::carry(Archive& archive) {
  pf::carry(archive, view_);
  pf::carry(archive, target_);
}

void KeyframeChoice::carry(Archive& archive) { archive.flags(is_away_, is_held_by_target_); }

void KeyframeAdjustment::carry(Archive& archive) {
  choice_.carry(archive);
  target_.carry(archive);
  archive.numbers(map_covariance_);
  auto& [keyframes, is_determined, is_away, given_held, span, hangs_on] = shape_;
  archive.within(keyframes, 1, Archive::kMaxCount);
  archive.flags(is_determined, is_away);
  archive.numbers(given_held, span);
  archive.counts(hangs_on);
}

}  // namespace pf
