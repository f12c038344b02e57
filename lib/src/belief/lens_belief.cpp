#include "belief/lens_belief.h"

#include <algorithm>
#include <cmath>

#include "belief/tuning.h"

namespace pf {

using namespace tuning::lens_belief;

Scalar lens_evidence(Scalar log_ratio, Scalar variance, Scalar known) {
  const Scalar kept = variance + std::max(kKept, known) * std::max(kKept, known);
  const Scalar changed = kept + kChange * kChange;
  const Scalar s2 = log_ratio * log_ratio;
  const Scalar evidence = (s2 / kept - s2 / changed - std::log(changed / kept)) / 2;
  return std::clamp(evidence, -tuning::pose_belief::kMaxFrame, tuning::pose_belief::kMaxFrame);
}

LensBelief::LensBelief() : before_(kLeast), log_odds_(kLeast) {}

void LensBelief::note(Scalar evidence, Scalar log_ratio) {
  log_odds_ = std::clamp(before_ + evidence, kLeast, kMost);
  log_ratio_ = log_ratio;
}

bool LensBelief::is_kept() const { return log_odds_ < kSuspected; }

bool LensBelief::has_changed() const { return log_odds_ > kCertain; }

}  // namespace pf
