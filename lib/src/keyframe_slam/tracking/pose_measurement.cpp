#include "keyframe_slam/tracking/pose_measurement.h"

#include <algorithm>
#include <cmath>

#include "base/elapsed.h"
#include "base/false_alarms.h"
#include "bundle/bearing.h"
#include "frame/ellipse.h"
#include "frame/tuning.h"
#include "keyframe_slam/map/rows.h"
#include "keyframe_slam/tracking/frame_time.h"
#include "keyframe_slam/tracking/tuning.h"

namespace pf {
namespace {

using namespace tuning::keyframe_tracking;

/// Probability that a search finds something by chance, and within this area [px^2].
Scalar chance_share(Scalar area, Scalar searched) {
  using namespace tuning::chance;
  return kMaxFindShare * std::min(Scalar(1), area / std::max(searched, kMinArea));
}

}  // namespace

Scalar PoseMeasurement::bound_px() const {
  return std::max(kBoundWidth * static_cast<Scalar>(settings_.camera.width), kBoundSigmas * noise_.sigma_gate());
}

/// A point as a match for the pose: m = R r + rho p_host, w = rho. Without a depth it has the median one, and as much again as standard
/// deviation; its noise has that times the baseline, the prior's and the uncertain part of it:
///
///   R += var(rho) (J_rho J_rhoᵀ + J_p P_p J_pᵀ / rho²)
void PoseMeasurement::make_match(int c, const PosePrior& prior, Scalar depth, int shared) {
  const Match& match = search_.match(c);
  const KeyframePoint& point = map_.point(match.feature);
  const Vec3& host_W = map_.keyframes[point.host].p_W;
  const Vec3 ray_W = map_.ray_W(match.feature);
  const Scalar rho = point.has_depth ? point.rho : 1 / depth;
  const Scalar variance = point.has_depth ? point.variance : static_cast<Scalar>(std::max(shared, 1)) * rho * rho;
  Vec2 z, J_rho;
  Mat26 J_C;
  PoseMatch& out = pose_.match(c);
  out.point = {ray_W + rho * host_W, rho, match_at_frame_time(map_, match, prior, depth)};
  out.noise = noise_.correlation_frames() * search_.point(c).noise;
  if (project_bearing(map_.camera(), prior.q_WC.toRotationMatrix(), ray_W, host_W - prior.p_W, rho, &z, &J_C, nullptr,
                      &J_rho)) {
    out.noise += variance * J_rho * J_rho.transpose();
    if (point.has_depth || shared == 0) return;
    const Mat23 J_p = J_C.rightCols<3>() / rho;
    const Mat3 P_p = prior.covariance.bottomRightCorner<3, 3>();
    out.noise += variance * J_p.lazyProduct(P_p).lazyProduct(J_p.transpose());
  }
}

int PoseMeasurement::find(int found, const PosePrior& prior, CameraPose* pose, Mat6* information) {
  StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kGate]);
  for (int c = 0; c < found; ++c) make_match(c, prior, Scalar(1), 0);
  const int inliers = pose_.find(map_.camera(), found, prior, bound_px(), settings_.min_inliers, pose, information);
  const Scalar circle = ellipse_area(Mat2::Identity() * (bound_px() * bound_px()), Scalar(1));
  Scalar shares = 0;
  for (int c = 0; c < found; ++c) shares += chance_share(circle, search_.point(c).searched);
  return is_believed(inliers, found, shares) ? inliers : 0;
}

int PoseMeasurement::fit(int found, const PosePrior& prior, Scalar depth, int shared, CameraPose* pose,
                         Mat6* information) {
  StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kGate]);
  for (int c = 0; c < found; ++c) {
    make_match(c, prior, depth, shared);
    if (has_rows(map_.camera()))
      pose_.match(c).point.pixel = followed_at_frame_time(map_, search_.match(c), frame_.report.t_ns);
  }
  return pose_.fit(map_.camera(), found, prior, settings_.gate, pose, information);
}

bool PoseMeasurement::is_supported(int inliers, int found) const {
  if (inliers < settings_.min_inliers) return false;
  Scalar shares = 0;
  for (int c = 0; c < found; ++c) shares += chance_share(agreeing_area(c), search_.point(c).searched);
  return is_believed(inliers, found, shares) || most_agree(found);
}

/// Half of what was searched for agrees, or far more than chance would give: with n of m matches within the bound, by chance each with its
/// chance_share(); shares: their sum.
bool PoseMeasurement::is_believed(int inliers, int found, Scalar shares) const {
  using namespace tuning::chance;
  if (inliers == 0) return false;
  if (tuning::image_front_end::kMinAgreeing * inliers >= frame_.report.attempts) return true;
  const Scalar share = std::clamp(shares / static_cast<Scalar>(found), kMinShare, kMaxShare);
  return log_false_alarms(inliers, frame_.report.attempts, share, found) < tuning::tracking::kMaxLogFalse;
}

/// Area within the searched ellipse in which a match agrees with the pose, by its own noise: along its epipolar line that may be all of it.
Scalar PoseMeasurement::agreeing_area(int c) const {
  const Mat2 S = pose_.match(c).noise + NoiseModel::search();
  const Mat2& searched = search_.match(c).innovation;
  const Scalar inside = S.determinant() * searched.determinant() / Mat2(S + searched).determinant();
  return ellipse_area(Mat2(Mat2::Identity() * std::sqrt(std::max(inside, Scalar(0)))), settings_.gate);
}

/// Whether of enough points that earlier frames have found at least half agree. Half of all corners are never found again, so new ones say
/// little by being missed.
bool PoseMeasurement::most_agree(int found) const {
  const auto is_old = [&](const Match& match) { return map_.feature(match.feature).observations > 1; };
  int searched = 0, agree = 0;
  for (int t = 0; t < frame_.match_count(); ++t) {
    const Match& match = frame_.match(t);
    searched += match.searched && match.feature >= 0 && is_old(match) ? 1 : 0;
  }
  for (int c = 0; c < found; ++c) agree += pose_.is_inlier(c) && is_old(search_.match(c)) ? 1 : 0;
  return searched >= settings_.min_inliers && tuning::image_front_end::kMinAgreeing * agree >= searched;
}

}  // namespace pf
