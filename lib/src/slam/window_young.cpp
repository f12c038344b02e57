#include "base/elapsed.h"
#include "slam/window_tracking.h"
#include "window/tuning.h"

/// WindowTracking while few depths are known, or none.

namespace pf {

void WindowTracking::measure_young(Scalar median_depth) {
  const PosePrior prior = {motion_.body().q_WC, motion_.body().p_W, motion_.pose_covariance()};
  listed_ = 0;
  listed_ = list(prior, true, median_depth);
  const int count = listed_ + list(prior, false, median_depth);
  const int found = search_for(0, count, prior, median_depth);
  int inliers = found;
  CameraPose pose = {prior.q_WC, prior.p_W};
  Mat6 information;
  {
    StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kGate]);
    int open = 0;
    for (int c = 0; c < found; ++c) open += map_.point(frame_.match(candidate_[c].match).feature).has_depth ? 0 : 1;
    for (int c = 0; c < found; ++c) make_pose_match(c, prior, median_depth, open);
    inliers = pose_.fit(map_.camera(), found, prior, settings_.gate, &pose, &information);
  }
  PosePrior now;
  if (inliers < settings_.min_inliers || 2 * inliers < frame_.report.attempts || !apply(pose, information, &now))
    return;
  for (int c = 0; c < found; ++c) {
    Match& match = frame_.match(candidate_[c].match);
    if (!pose_.is_inlier(c)) continue;
    ++frame_.report.inliers;
    accept(&match);
  }
}

int WindowTracking::follow(Scalar depth) {
  listed_ = 0;
  const PosePrior now = {motion_.body().q_WC, motion_.body().p_W, motion_.pose_covariance()};
  const int count = list(now, false, depth);
  const int found = search_for(0, count, now, depth);
  return found;
}

void WindowTracking::settle_followed(int found, const Quat& q_WC, const Vec3& p_W, Scalar depth) {
  using namespace tuning::window_start;
  PosePrior about = {q_WC, p_W, Mat6(Mat6::Identity() * (kRotationSigma * kRotationSigma))};
  about.covariance.bottomRightCorner<3, 3>() = Mat3::Identity() * (kPositionSigma * kPositionSigma * depth * depth);
  for (int c = 0; c < found; ++c) make_pose_match(c, about, depth, 0);
  CameraPose pose;
  Mat6 information;
  if (pose_.fit(map_.camera(), found, about, settings_.gate, &pose, &information) < settings_.min_inliers)
    pose = {q_WC, p_W};
  motion_.correct(pose.q_WC, pose.p_WC, about.covariance);
}

}  // namespace pf
