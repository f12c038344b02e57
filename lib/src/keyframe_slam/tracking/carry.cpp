#include "frame/kept/carry.h"

#include "keyframe_slam/tracking/keyframe_tracking.h"
#include "keyframe_slam/tracking/relocaliser.h"
#include "model/carry.h"
#include "vision/carry.h"

namespace pf {

void KeyframeMotion::carry(Archive& archive) {
  auto& [body, P, dv_C, dw_C, measured, max_nis] = data_;
  auto& [is_set, q_WC, p_W, R] = measured;
  pf::carry(archive, body);
  archive.numbers(P, dv_C, dw_C, q_WC, p_W, R, max_nis);
  archive.flags(is_set);
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
  if (!archive.is_reading()) return;
  found_ = 0;
  first_ = First();
}

void KeyframeRelocaliser::carry(Archive& archive) {
  views_.carry(archive);
  recall_.carry(archive);
  pf::carry(archive, proposal_);
  pf::carry(archive, rival_);
  archive.any(recalled_);
  archive.flags(recalled_in_vain_);
  auto& [last, judged] = asked_;
  for (Asked* asked : {&last, &judged}) {
    auto& [view, depth, is_described] = *asked;
    pf::carry(archive, view);
    archive.numbers(depth);
    archive.flags(is_described);
  }
  joins_.carry(archive);
}

}  // namespace pf
