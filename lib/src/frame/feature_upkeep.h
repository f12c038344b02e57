#pragma once

#include <algorithm>

#include "base/elapsed.h"
#include "belief/feature_belief.h"
#include "belief/pose_evidence.h"
#include "frame/frame.h"
#include "map/map.h"

/// What both back ends learn of features from the searches of a frame.

namespace pf {

/// Reliability of a feature: the rate of its successes times its number of measurements, which counts up to 20.
inline float reliability(const Feature& f) {
  const int rated = std::min(f.observations, 20);
  return static_cast<float>(rated) * static_cast<float>(f.observations + 1) / static_cast<float>(f.attempts + 1);
}

/// A feature was searched for and was an inlier, or was not. share: of the frame's searches that found something.
inline void note_search(bool found, Scalar share, Feature* feature) {
  feature->log_odds =
      static_cast<float>(updated_feature(static_cast<Scalar>(feature->log_odds), feature_evidence(found, share)));
  feature->was_missed = !found;
}

/// Counts the searches of a frame and updates the log-odds of their features. In a frame that does not support its pose only inliers count:
/// a feature that it did not find may have been elsewhere.
inline void count_searches(const Frame& frame, const FindShare& mean, FeatureTable* features, bool supported = true) {
  int searched = 0, inliers = 0;
  for (int t = 0; t < frame.match_count(); ++t) {
    if (!frame.match(t).searched) continue;
    ++searched;
    inliers += frame.match(t).status == MatchStatus::kInlier ? 1 : 0;
  }
  const Scalar share = mean.in_frame(searched, inliers);
  for (int t = 0; t < frame.match_count(); ++t) {
    const Match& match = frame.match(t);
    const bool found = match.status == MatchStatus::kInlier;
    if (match.feature < 0 || !match.searched || !(supported || found)) continue;
    Feature& f = (*features)[match.feature];
    count_frame(&f.attempts);
    note_search(found, share, &f);
    if (match.status == MatchStatus::kOutlier) count_frame(&f.rejections);
  }
}

}  // namespace pf
