#include "keyframe_slam/tracking/relocaliser.h"

#include "frame/tuning.h"
#include "geometry/so3.h"

namespace pf {

using namespace tuning::relocaliser;

bool KeyframeRelocaliser::is_prediction_narrow(Scalar median_depth) const {
  const Mat6 P = motion_.pose_covariance();
  const Scalar position = kNearbySigma * median_depth;
  return P(0, 0) + P(1, 1) + P(2, 2) < kNearbySigma * kNearbySigma && P(3, 3) + P(4, 4) + P(5, 5) < position * position;
}

void KeyframeRelocaliser::recover(Scalar median_depth) {
  const PoseProposal before = proposal_;
  PoseHypothesis elsewhere;
  CameraPose pose;
  Mat6 information;
  PoseConsensus consensus;
  const bool chosen = find_elsewhere(before, views_, tracker_.pyramid(), map_.camera(), median_depth, &elsewhere);
  const PosePrior about = {elsewhere.q_WC, elsewhere.p_W, elsewhere.P};
  proposal_ = PoseProposal();
  if (!chosen || measuring_.measure_about(about, &pose, &information, &consensus) < settings_.min_inliers) return;
  const bool follows = before.is_set && log_so3(pose.q_WC * before.q_WC.conjugate()).norm() < kAboutView &&
                       (pose.p_WC - before.p_W).norm() < kAboutView * median_depth;
  const Scalar log_odds =
      PoseBelief::updated(follows ? before.log_odds : PoseBelief::elsewhere(), belief_.evidence(consensus));
  proposal_ = {true, log_odds, pose.q_WC, pose.p_WC, median_depth};
  if (!PoseBelief::is_enough(log_odds)) return;
  motion_.set_pose_covariance(about.covariance);
  measuring_.correct(pose, information);
  belief_.use(log_odds, consensus);
  proposal_ = PoseProposal();
}

}  // namespace pf
