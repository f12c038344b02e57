#pragma once

#include "base/archive.h"
#include "frame/pose_hypotheses.h"
#include "map/feature_table.h"

namespace pf {

/// Archive.
inline void carry(Archive& archive, PoseProposal& proposal) {
  auto& [is_set, log_odds, q_WC, p_W, depth] = proposal;
  archive.flags(is_set);
  archive.numbers(log_odds, q_WC, p_W, depth);
}

/// What is known of a kind of residuals.
inline void carry(Archive& archive, ResidualTrace& trace) {
  auto& [mean, frame] = trace;
  archive.numbers(mean);
  archive.counts(frame);
}

}  // namespace pf
