#include "keyframe_slam/tracking/body_correction.h"

#include "geometry/small_cholesky.h"
#include "keyframe_slam/tracking/tuning.h"

namespace pf {

bool correct_body(const CameraPose& pose, Mat6 information, KeyframeMotion* motion, PosePrior* now) {
  SmallCholesky<6, double> factored;
  if (!factored.factor(information.cast<double>())) {
    SmallCholesky<6> prior;
    if (!prior.factor(motion->pose_covariance())) return false;
    information += tuning::keyframe_tracking::kWeakPrior * prior.inverse();
    if (!factored.factor(information.cast<double>())) return false;
  }
  const KeyframeMotion::Wide6 R = factored.inverse();
  const bool corrected = motion->correct(pose.q_WC, pose.p_WC, R);
  *now = {pose.q_WC, pose.p_WC, R.cast<Scalar>(), motion->body().v_W, motion->body().w_C};
  return corrected;
}

bool follow_velocities(const CameraPose& pose, const Mat6& information, KeyframeMotion* motion) {
  SmallCholesky<6, double> factored;
  return factored.factor(information.cast<double>()) && motion->correct(pose.q_WC, pose.p_WC, factored.inverse());
}

}  // namespace pf
