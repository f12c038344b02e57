#pragma once

#include "geometry/p3p.h"
#include "keyframe_slam/tracking/pose_prior.h"

/// Updates the body with a pose that was fitted to matches, with its information.

namespace pf {

/// What the matches do not determine, the prediction does. now: the pose with the covariance that the matches leave. False where that is no
/// covariance; of the body nothing has changed then.
bool correct_body(const CameraPose& pose, Mat6 information, KeyframeMotion* motion, PosePrior* now);

/// The same where the matches determine the pose alone. The velocities follow from how far the camera is from where it was predicted.
bool follow_velocities(const CameraPose& pose, const Mat6& information, KeyframeMotion* motion);

}  // namespace pf
