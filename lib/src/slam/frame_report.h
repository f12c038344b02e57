#pragma once

#include <cstdint>

#include "base/eigen.h"
#include "filter/state.h"

namespace pf {

/// With the numbers of pf_state_t.
enum class SlamState : int { kStarting = 0, kTracking = 1, kCoasting = 2, kLost = 3 };

/// With the numbers of pf_track_status_t.
enum class TrackStatus : int { kInlier = 1, kOutlier = 2, kMissed = 3, kNew = 4 };

/// One feature in one frame.
struct Track {
  int feature;  ///< entry in the feature table; -1 once it has gone, or where it could not be predicted
  std::uint32_t id;
  TrackStatus status;
  BlockKind kind;
  Vec2 predicted;
  Mat2 innovation;
  Vec2 measured;
  Scalar nis;  ///< normalised innovation squared of the match alone, two degrees of freedom; zero without a match
};

enum Stage { kPyramid, kPredict, kSearch, kGate, kUpdate, kMap, kStageCount = 8 };

struct FrameReport {
  std::int64_t t_ns = 0;
  int frames = 0;
  int attempts = 0, matches = 0, inliers = 0, new_features = 0, evicted = 0;
  double nis = 0;
  int nis_dof = 0;
  std::int64_t stage_ns[kStageCount] = {};
};

}  // namespace pf
