#pragma once

#include "geometry/p3p.h"
#include "keyframe_slam/tracking/pose_prior.h"

/// Updates the body with a pose that was fitted to matches, with its information.

namespace pf {

/// Where the matches leave a direction open, the prediction counts. now: the pose with its covariance after the matches. False, with the
/// body unchanged, where that is no covariance.
bool correct_body(const CameraPose& pose, Mat6 information, KeyframeMotion* motion, PosePrior* now);

/// The same where the matches alone determine the pose. The velocities follow from its difference to the prediction.
bool follow_velocities(const CameraPose& pose, const Mat6& information, KeyframeMotion* motion);

}  // namespace pf
