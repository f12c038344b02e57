#include "belief/pose_belief.h"

#include <algorithm>
#include <cmath>

#include "belief/tuning.h"

namespace pf {

using namespace tuning::pose_belief;

void PoseBelief::init() {
  share_.init();
  alike_.init();
  lens_ = LensBelief();
  sharpness_.init();
  log_odds_ = predicted_ = least_ = kAnew;
  is_noted_ = false;
}

void PoseBelief::begin_frame(double dt_s) {
  const double before = static_cast<double>(log_odds());
  // 1 - p of what was right, and has ended since: e^-L + (1 - e^(-h dt)) (1 + e^-L) over e^(-h dt).
  const double kept = std::exp(-kHazard * dt_s);
  const double odds = kept / (std::exp(-before) + (1 - kept));
  predicted_ = std::max(least_, static_cast<Scalar>(std::log(odds)));
  log_odds_ = predicted_;
  is_noted_ = false;
  lens_.begin_frame();
  sharpness_.note_none();
  share_.begin_frame(1);
}

void PoseBelief::note_sharpness(Scalar log_sharpness) {
  sharpness_.note(log_sharpness);
  share_.begin_frame(sharpness_.as_sharp());
}

void PoseBelief::begin_elsewhere() {
  init();
  log_odds_ = predicted_ = least_ = kElsewhere;
}

void PoseBelief::spend() { predicted_ = log_odds_ = kElsewhere; }

Scalar PoseBelief::anew() { return kAnew; }

Scalar PoseBelief::elsewhere() { return kElsewhere; }

Scalar PoseBelief::most() { return kMost; }

Scalar PoseBelief::updated(Scalar before, Scalar evidence) {
  return std::clamp(before + std::clamp(evidence, -kMaxFrame, kMaxFrame), kElsewhere, kMost);
}

void PoseBelief::note(Scalar log_odds) {
  log_odds_ = is_noted_ ? std::max(log_odds_, log_odds) : log_odds;
  is_noted_ = true;
}

void PoseBelief::use(Scalar log_odds, const PoseConsensus& consensus) {
  log_odds_ = log_odds;
  if (is_enough(log_odds)) least_ = kAnew;
  is_noted_ = true;
  share_.learn(consensus.searched, consensus.inliers);
  if (consensus.searched > 0) sharpness_.learn();
}

bool PoseBelief::is_enough(Scalar log_odds) { return log_odds >= kTracked; }

bool PoseBelief::may_use(Scalar log_odds, const PoseConsensus& consensus) {
  if (!is_enough(log_odds)) return false;
  lens_.note(consensus.lens_evidence, consensus.log_zoom);
  return lens_.is_kept();
}

bool PoseBelief::is_settled(Scalar log_odds) { return is_enough(updated(log_odds, -kMaxFrame)); }

}  // namespace pf
