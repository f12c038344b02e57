#include "keyframe_slam/tracking/relocaliser.h"

#include "frame/tuning.h"
#include "geometry/so3.h"

namespace pf {

using namespace tuning::relocaliser;

namespace {

Mat6 sphere(Scalar rotation, Scalar position) {
  Mat6 P = Mat6::Zero();
  for (int i = 0; i < 3; ++i) {
    P(i, i) = rotation * rotation;
    P(3 + i, 3 + i) = position * position;
  }
  return P;
}

}  // namespace

bool KeyframeRelocaliser::is_prediction_narrow(Scalar median_depth) const {
  const Mat6 P = motion_.pose_covariance();
  const Scalar position = kNearbySigma * median_depth;
  return P(0, 0) + P(1, 1) + P(2, 2) < kNearbySigma * kNearbySigma && P(3, 3) + P(4, 4) + P(5, 5) < position * position;
}

/// Where to search; false where nothing says it.
bool KeyframeRelocaliser::choose(Scalar median_depth, PosePrior* about) const {
  if (data_.is_set) {
    *about = {data_.q_WC, data_.p_W, sphere(kAboutProposal, kAboutProposal * median_depth)};
    return true;
  }
  const Recognition place = views_.recognise(tracker_.pyramid(), map_.camera());
  if (place.score < kMinRecognition) return false;
  *about = {place.q_WC, place.p_W, sphere(kAboutView, kAboutView * median_depth)};
  return true;
}

void KeyframeRelocaliser::recover(Scalar median_depth) {
  const Data before = data_;
  PosePrior about;
  CameraPose pose;
  Mat6 information;
  PoseConsensus consensus;
  const bool chosen = choose(median_depth, &about);
  data_ = Data();
  if (!chosen || measuring_.measure_about(about, &pose, &information, &consensus) < settings_.min_inliers) return;
  const bool follows = before.is_set && log_so3(pose.q_WC * before.q_WC.conjugate()).norm() < kAboutView &&
                       (pose.p_WC - before.p_W).norm() < kAboutView * median_depth;
  const Scalar log_odds =
      PoseBelief::updated(follows ? before.log_odds : PoseBelief::elsewhere(), belief_.evidence(consensus));
  data_ = {true, log_odds, pose.q_WC, pose.p_WC};
  if (!PoseBelief::is_enough(log_odds)) return;
  motion_.set_pose_covariance(about.covariance);
  measuring_.correct(pose, information);
  belief_.use(log_odds, consensus);
  data_ = Data();
}

}  // namespace pf
