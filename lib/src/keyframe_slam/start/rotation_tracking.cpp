#include "keyframe_slam/start/rotation_tracking.h"

#include "bundle/rotation_fit.h"
#include "keyframe_slam/start/tuning.h"
#include "keyframe_slam/tracking/frame_time.h"

namespace pf {

using namespace tuning::keyframe_start;

namespace {

/// Found in this frame, and not accepted yet.
bool is_found(const Match& match) { return match.status == MatchStatus::kOutlier && match.feature >= 0; }

}  // namespace

bool RotationTracking::layout(Arena& arena) {
  const std::size_t points = static_cast<std::size_t>(settings_.max_features);
  pixel_ = arena.take<BundlePixel>(points);
  return arena.ok();
}

/// Lists all points.
int RotationTracking::list() { return search_.list_unplaced(prior_of(motion_), settings_.start_depth); }

/// Searches for the points that have just been listed. Returns how many are found.
int RotationTracking::search(int listed, bool follows) {
  PosePrior at = prior_of(motion_);
  at.follows = follows;
  return search_.search(0, 0, listed, at, settings_.start_depth);
}

/// Once more, about the other place.
int RotationTracking::search_again(bool follows) {
  frame_.forget_searches();
  return search(list(), follows);
}

/// About where the image as a whole has moved, which tells the rotation better than a motion model; with samples of a gyroscope about where
/// the motion has them. Either may be wrong (something moves before the camera, samples are missing): where few are found, about the other
/// as well, and the better counts. Returns how many are found.
int RotationTracking::find_points(const FindShare& share) {
  const int listed = list();
  const bool follows = !settings_.inertial && search_.find_followed();
  const int found = search(listed, follows);
  if (!share.is_unlikely(frame_.report.attempts, found)) return found;
  if (!follows && !(settings_.inertial && search_.find_followed())) return found;
  const int otherwise = search_again(!follows);
  return otherwise >= found ? otherwise : search_again(follows);
}

/// Rays and pixels of what was found. Returns how many.
int RotationTracking::list_rays() {
  int count = 0;
  for (int t = 0; t < frame_.match_count() && count < settings_.max_features; ++t) {
    const Match& match = frame_.match(t);
    if (!is_found(match)) continue;
    map_.scratch().vector[count] = map_.ray_W(match.feature);
    const Vec2 pixel = followed_at_frame_time(map_, match, frame_.report.t_ns);
    pixel_[count++] = {static_cast<float>(pixel.x()), static_cast<float>(pixel.y()), true};
  }
  return count;
}

bool RotationTracking::measure(const Vec3& base_W, const FindShare& share) {
  const int found = find_points(share);
  if (found < settings_.min_inliers) return false;
  Quat q_WC = motion_.body().q_WC;
  const int count = list_rays();
  const Scalar parallax =
      fit_rotation(map_.camera(), map_.scratch().vector, pixel_, count, map_.scratch().number, &q_WC);
  const Scalar bound = kParallaxes * parallax + pose_.bound_px();
  correct_body(found, q_WC, base_W);
  const CameraView seen_from = motion_.view();
  for (int t = 0; t < frame_.match_count(); ++t) {
    Match& match = frame_.match(t);
    Vec2 z;
    if (!is_found(match) || !project(map_.camera(), q_WC.conjugate() * map_.ray_W(match.feature), &z)) continue;
    const Vec2 pixel = followed_at_frame_time(map_, match, frame_.report.t_ns);
    if ((pixel - z).squaredNorm() > bound * bound) continue;
    accept_match(seen_from, pixel, frame_.report.t_ns, &map_, &match);
    ++frame_.report.inliers;
  }
  return frame_.report.inliers >= settings_.min_inliers;
}

/// Updates the body with the pose fitted to all found points about the known rotation; with the rotation alone where the fit fails.
void RotationTracking::correct_body(int found, const Quat& q_WC, const Vec3& p_W) {
  const Scalar depth = settings_.start_depth;
  PosePrior about = {q_WC, p_W, Mat6(Mat6::Identity() * (kRotationSigma * kRotationSigma))};
  about.covariance.bottomRightCorner<3, 3>() = Mat3::Identity() * (kPositionSigma * kPositionSigma * depth * depth);
  about.v_W = motion_.body().v_W;
  about.w_C = motion_.body().w_C;
  CameraPose pose;
  Mat6 information;
  if (pose_.fit(found, about, depth, 0, &pose, &information) < settings_.min_inliers) pose = {q_WC, p_W};
  motion_.correct(pose.q_WC, pose.p_WC, about.covariance.cast<double>());
}

}  // namespace pf
