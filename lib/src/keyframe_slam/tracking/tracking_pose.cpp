#include "base/elapsed.h"
#include "geometry/small_cholesky.h"
#include "keyframe_slam/tracking/tracking.h"
#include "keyframe_slam/tracking/tuning.h"

/// KeyframeTracking: the pose of a frame, and where to search when the motion model cannot tell (followed_view.h).

namespace pf {

using namespace tuning::keyframe_tracking;

void KeyframeTracking::keep_view() {
  followed_.keep(search_.tracker().pyramid(), motion_.body().q_WC, motion_.body().p_W);
}

bool KeyframeTracking::is_wide(const Mat2& innovation) const {
  return FollowedView::is_wide(map_.camera(), innovation, settings_.gate);
}

/// Where most ellipses are wide, searches go about the places where the picture as a whole has gone, from now on. False: they are not, or
/// the picture does not say it.
bool KeyframeTracking::begin_following() {
  int wide = 0;
  for (int t = 0; t < frame_.match_count(); ++t) wide += is_wide(frame_.match(t).innovation) ? 1 : 0;
  if (wide == 0 || 2 * wide < frame_.match_count()) return false;
  StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kSearch]);
  is_following_ = followed_.find(map_.camera(), search_.tracker().pyramid());
  return is_following_;
}

/// Directs a search to where the followed view has the point, unless its own ellipse says as much. False where that has no place for it.
bool KeyframeTracking::aim(int i, SearchTask* task) const {
  if (!is_wide(task->innovation)) return true;
  const KeyframePoint& point = map_.point(i);
  Vec3 at_W = task->p_W;
  if (!point.has_depth) {
    Vec3 ray_C;
    if (!unproject(map_.camera(), point.pixel, &ray_C)) return false;
    at_W = followed_.p_W() + point.seen_from.q_WC * ray_C;
  }
  return followed_.aim(map_.camera(), at_W, task);
}

void KeyframeTracking::measure(Scalar median_depth) {
  const PosePrior prior = now();
  CameraPose pose;
  Mat6 information;
  if (measure_about(prior, &pose, &information) == 0) {
    measure_all(median_depth);
    if (frame_.report.inliers > 0 || !begin_following()) return;
    frame_.forget_searches();
    const bool found = measure_about(prior, &pose, &information) > 0;
    if (!found) measure_all(median_depth);
    is_following_ = false;
    if (!found) return;
  }
  if (has_rows())
    correct_by_rows(prior, pose, information);
  else
    correct(pose, information);
  measure_unplaced(median_depth);
}

void KeyframeTracking::correct(const CameraPose& pose, const Mat6& information) {
  PosePrior now;
  if (apply(pose, information, &now)) mark(frame_.report.matches, now);
}

/// Corrects the body by a measured pose. False where its covariance is none. now: the pose with the covariance that the matches leave.
bool KeyframeTracking::apply(const CameraPose& pose, Mat6 information, PosePrior* now) {
  StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kUpdate]);
  SmallCholesky<6, double> factored;
  // What the matches do not determine, the prediction does.
  if (!factored.factor(information.cast<double>())) {
    SmallCholesky<6> prior;
    if (!prior.factor(motion_.pose_covariance())) return false;
    information += kWeakPrior * prior.inverse();
    if (!factored.factor(information.cast<double>())) return false;
  }
  const KeyframeMotion::Wide6 R = factored.inverse();
  const bool corrected = motion_.correct(pose.q_WC, pose.p_WC, R);
  *now = {pose.q_WC, pose.p_WC, R.cast<Scalar>(), motion_.body().v_W, motion_.body().w_C};
  return corrected;
}

}  // namespace pf
