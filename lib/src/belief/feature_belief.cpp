#include "belief/feature_belief.h"

#include <algorithm>
#include <cmath>

#include "belief/tuning.h"

namespace pf {

using namespace tuning::feature_belief;

Scalar feature_evidence(bool found, Scalar share) {
  const Scalar q = tuning::chance::kMaxFindShare;
  const Scalar d = std::clamp(share, q, tuning::find_share::kGreatest);
  return found ? std::log(d / q) : std::log((1 - d) / (1 - q));
}

Scalar updated_feature(Scalar log_odds, Scalar evidence) { return std::min(log_odds + evidence, kMost); }

bool is_no_point(Scalar log_odds) { return log_odds < kNone; }

}  // namespace pf
