#include "frame/kept/carry.h"

#include "keyframe_slam/tracking/keyframe_tracking.h"
#include "keyframe_slam/tracking/relocaliser.h"
#include "model/carry.h"
#include "vision/carry.h"

namespace pf {

void KeyframeMotion::carry(Archive& archive) {
  auto& [body, P] = data_;
  pf::carry(archive, body);
  archive.numbers(P);
}

/// Points that were searched for are those of a frame that is over.
void PointSearch::carry(Archive& archive) {
  images_.carry(archive);
  followed_.carry(archive);
  if (archive.is_reading()) placed_ = 0;
}

void KeyframePose::carry(Archive& archive) { archive.any(random_); }

void PoseMeasurement::carry(Archive& archive) { pose_.carry(archive); }

void KeyframeTracking::carry(Archive& archive) {
  hypotheses_.carry(archive);
  if (archive.is_reading()) found_ = 0;
}

void KeyframeRelocaliser::carry(Archive& archive) {
  views_.carry(archive);
  recall_.carry(archive);
  pf::carry(archive, proposal_);
  pf::carry(archive, rival_);
  archive.any(recalled_);
  archive.flags(recalled_in_vain_);
  auto& [view, depth, is_described] = asked_;
  pf::carry(archive, view);
  archive.numbers(depth);
  archive.flags(is_described);
}

}  // namespace pf
