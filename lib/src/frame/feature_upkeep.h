#pragma once

#include <algorithm>

#include "base/elapsed.h"
#include "frame/frame.h"
#include "frame/tuning.h"
#include "map/map.h"

/// What both back ends count of features, and what follows from it.

namespace pf {

/// How reliable a feature is: the rate of its successes, of proven ones more.
inline float reliability(const Feature& f) {
  const int rated = std::min(f.observations, 20);
  return static_cast<float>(rated) * static_cast<float>(f.observations + 1) / static_cast<float>(f.attempts + 1);
}

/// Whether a feature is found too seldom to be kept, or was not found too many times in a row.
inline bool fails_too_often(const Feature& f) {
  using namespace tuning::feature_keeper;
  const bool seldom = f.attempts >= kMinAttempts && kMaxAttempts * f.observations < f.attempts;
  const bool in_a_row = f.failures >= (f.observations < kMinAttempts ? kMaxEarlyFailures : kMaxFailures);
  return (f.failures > 0 && seldom) || in_a_row;
}

/// Counts the searches of a frame: attempts, failures and rejections. Of one that does not support its pose: attempts of what was taken all
/// the same, and no failures.
inline void count_searches(const Frame& frame, FeatureTable* features, bool supported = true) {
  for (int t = 0; t < frame.match_count(); ++t) {
    const Match& match = frame.match(t);
    if (match.feature < 0 || !match.searched) continue;
    if (!supported && match.status != MatchStatus::kInlier) continue;
    Feature& f = (*features)[match.feature];
    count_frame(&f.attempts);
    if (match.status == MatchStatus::kInlier) continue;
    count_frame(&f.failures);
    if (match.status == MatchStatus::kOutlier) count_frame(&f.rejections);
  }
}

}  // namespace pf
