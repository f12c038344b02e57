#include "keyframe_slam/tracking/pose_measurement.h"

#include <algorithm>
#include <cmath>

#include "base/elapsed.h"
#include "bundle/bearing.h"
#include "bundle/zoom_fit.h"
#include "frame/pose_hypotheses.h"
#include "frame/tuning.h"
#include "keyframe_slam/map/readout.h"
#include "keyframe_slam/map/rows.h"
#include "keyframe_slam/tracking/frame_time.h"
#include "keyframe_slam/tracking/tuning.h"

namespace pf {
namespace {

using namespace tuning::keyframe_tracking;

}  // namespace

Scalar PoseMeasurement::bound_px() const {
  return std::max(kBoundWidth * static_cast<Scalar>(settings_.camera.width), kBoundSigmas * noise_.sigma_gate());
}

/// A point as a match for the pose: m = R r + rho p_host, w = rho. Without a depth it has the median one.
void PoseMeasurement::make_match(int c, const PosePrior& prior, Scalar depth, int shared) {
  const Match& match = search_.match(c);
  const KeyframePoint& point = map_.point(match.feature);
  const Scalar rho = point.has_depth ? point.rho : 1 / depth;
  PoseMatch& out = pose_.match(c);
  out.point = {map_.ray_W(match.feature) + rho * map_.keyframes[point.host].p_W, rho,
               match_at_frame_time(map_, match, prior, depth)};
  out.noise = noise_of(c, prior, depth, shared);
  out.by_readout = Vec2::Zero();
  const Scalar variance = map_.lens().readout_variance();
  if (variance > Scalar(0))
    out.by_readout =
        std::sqrt(variance) * expected_by_readout(map_, match.feature, prior.body(), rho, match.measured.y());
}

/// Noise of a point without a depth of its own, taken at the median depth with the same standard deviation, times the baseline (the prior's
/// and its uncertain part):
///
///   R += var(rho) (J_rho J_rhoᵀ + J_p P_p J_pᵀ / rho²)
Mat2 PoseMeasurement::noise_of(int c, const PosePrior& prior, Scalar depth, int shared) const {
  const int feature = search_.match(c).feature;
  const KeyframePoint& point = map_.point(feature);
  const Vec3& host_W = map_.keyframes[point.host].p_W;
  const Scalar rho = point.has_depth ? point.rho : 1 / depth;
  const Scalar variance = point.has_depth ? point.variance : static_cast<Scalar>(std::max(shared, 1)) * rho * rho;
  Mat2 noise = noise_.correlation_frames() * search_.point(c).noise;
  Vec2 z, J_rho;
  Mat26 J_C;
  if (!project_bearing(map_.camera(), prior.q_WC.toRotationMatrix(), map_.ray_W(feature), host_W - prior.p_W, rho, &z,
                       &J_C, nullptr, &J_rho))
    return noise;
  noise += variance * J_rho * J_rho.transpose();
  if (point.has_depth || shared == 0) return noise;
  const Mat23 J_p = J_C.rightCols<3>() / rho;
  const Mat3 P_p = prior.covariance.bottomRightCorner<3, 3>();
  return noise + variance * J_p.lazyProduct(P_p).lazyProduct(J_p.transpose());
}

int PoseMeasurement::find(int found, const PosePrior& prior, CameraPose* pose, Mat6* information) {
  StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kGate]);
  for (int c = 0; c < found; ++c) make_match(c, prior, Scalar(1), 0);
  return pose_.find(map_.camera(), found, prior, bound_px(), settings_.min_inliers, pose, information);
}

int PoseMeasurement::fit(int found, const PosePrior& prior, Scalar depth, int shared, CameraPose* pose,
                         Mat6* information) {
  StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kGate]);
  for (int c = 0; c < found; ++c) {
    make_match(c, prior, depth, shared);
    if (has_rows(map_.camera()))
      pose_.match(c).point.pixel = followed_at_frame_time(map_, search_.match(c), frame_.report.t_ns);
  }
  const int inliers = pose_.fit(map_.camera(), found, prior, settings_.gate, pose, information);
  // How likely the pixels are is a question of each one's own depth.
  for (int c = 0; c < found && shared > 1; ++c) pose_.match(c).noise = noise_of(c, prior, depth, 1);
  return inliers;
}

/// By points that have a depth; each with the noise that its depth adds.
void PoseMeasurement::weigh_lens(int found, const CameraPose& pose, PoseConsensus* consensus) const {
  ZoomPoints points;
  for (int c = 0; c < found; ++c) {
    if (!pose_.is_inlier(c) || !map_.point(search_.match(c).feature).has_depth) continue;
    const PoseMatch& match = pose_.match(c);
    points.add(match.point, match.noise.trace() / 2, match.by_readout);
  }
  note_zoom(points.fit(map_.camera(), pose), settings_, consensus);
}

PoseConsensus PoseMeasurement::consensus(int inliers, int found, const PosePrior& prior, const CameraPose& pose,
                                         const Mat6& information) const {
  PoseConsensus consensus;
  consensus.searched = frame_.report.attempts;
  frame_.forget_agreement();
  if (inliers == 0) return consensus;
  consensus.inliers = inliers;
  consensus.log_density = log_density(map_.camera(), &pose_.match(0), found, pose_.inliers(), prior, pose, information);
  for (int c = 0; c < found; ++c) {
    if (!pose_.is_inlier(c)) continue;
    frame_.match(search_.point(c).match).agrees = true;
    consensus.log_chance += log_chance_density(search_.point(c).searched);
  }
  return consensus;
}

}  // namespace pf
