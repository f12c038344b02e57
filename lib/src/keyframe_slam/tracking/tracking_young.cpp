#include <algorithm>
#include <cmath>
#include <utility>

#include "base/elapsed.h"
#include "frame/ellipse.h"
#include "keyframe_slam/map/depth.h"
#include "keyframe_slam/tracking/tracking.h"
#include "keyframe_slam/tracking/tuning.h"

/// KeyframeTracking where depths are not known: of some points, of most while the map is young, of none.

namespace pf {

/// About the last pixel, for depths about the median: rho = (1 +- kOpenSpread) / depth along the ray on which it was last seen.
bool KeyframeTracking::expect_unplaced(int i, const PosePrior& at, Scalar depth, ExpectedPixel* out) const {
  using tuning::keyframe_tracking::kOpenSpread;
  const KeyframePoint& point = map_.point(i);
  Vec3 ray_C;
  if (!unproject(map_.camera(), point.pixel, &ray_C)) return false;
  Mat26 J_C;
  Vec2 J_rho;
  if (!project_bearing(map_.camera(), at.q_WC.toRotationMatrix(), point.seen_from.q_WC * ray_C,
                       point.seen_from.c_W - at.p_W, 1 / depth, &out->pixel, &J_C, nullptr, &J_rho))
    return false;
  const Mat26 JP = J_C.lazyProduct(at.covariance);
  out->spread =
      JP.lazyProduct(J_C.transpose()) + kOpenSpread * kOpenSpread * J_rho * J_rho.transpose() / (depth * depth);
  if (!has_rows()) return true;
  if (!expect_row(at, point.seen_from.q_WC * ray_C + point.seen_from.c_W / depth, 1 / depth, out)) return false;
  out->spread += kOpenSpread * kOpenSpread * J_rho * J_rho.transpose() / (depth * depth);
  return true;
}

/// Points without a depth: where the corrected pose leaves no depth that explains their pixel, it is wrong.
void KeyframeTracking::measure_unplaced(Scalar depth) {
  const PosePrior at = now();
  const int count = list(at, false, depth), first = listed_;
  const int found = search_for(first, count, at, depth);
  for (int c = first; c < first + found; ++c) {
    Match& match = frame_.match(candidate_[c].match);
    const Vec2 pixel = match_at_frame_time(match, at, depth);
    DepthFit fit;
    const bool fits = fit_depth(map_.camera(), map_, match.feature, {at.q_WC, at.p_W}, pixel, &fit);
    if (fits ? fit.worst_px > bound_px() : fit.cos_parallax < std::cos(tuning::keyframe_tracking::kMaxParallel))
      continue;
    accept(&match, pixel);
  }
}

void KeyframeTracking::measure_young(Scalar median_depth) {
  const PosePrior prior = now();
  listed_ = 0;
  listed_ = list(prior, true, median_depth);
  const int count = listed_ + list(prior, false, median_depth);
  fit_all(search_for(0, count, prior, median_depth), prior, median_depth);
}

/// After measure_about() found no pose: the points without a depth are searched for as well.
void KeyframeTracking::measure_all(Scalar median_depth) {
  const PosePrior prior = now();
  const int count = list(prior, false, median_depth);
  const int more = search_for(listed_, count, prior, median_depth);
  int found = found_;
  for (int k = 0; k < more; ++k, ++found)
    if (found != listed_ + k) std::swap(candidate_[found], candidate_[listed_ + k]);
  fit_all(found, prior, median_depth);
}

/// Area within the searched ellipse in which a match agrees with the pose, by its own noise: along its epipolar line that may be all of it.
Scalar KeyframeTracking::agreeing_area(int c) const {
  const Mat2 S = pose_.match(c).noise + NoiseModel::search();
  const Mat2& searched = frame_.match(candidate_[c].match).innovation;
  const Scalar inside = S.determinant() * searched.determinant() / Mat2(S + searched).determinant();
  return ellipse_area(Mat2(Mat2::Identity() * std::sqrt(std::max(inside, Scalar(0)))), settings_.gate);
}

/// Whether of enough points that earlier frames have found at least half agree. Half of all corners are never found again, so new ones say
/// little by being missed.
bool KeyframeTracking::most_agree(int found) const {
  int searched = 0, agree = 0;
  for (int t = 0; t < frame_.match_count(); ++t) {
    const Match& match = frame_.match(t);
    searched += match.searched && match.feature >= 0 && map_.feature(match.feature).observations > 1 ? 1 : 0;
  }
  for (int c = 0; c < found; ++c)
    agree += pose_.is_inlier(c) && map_.feature(frame_.match(candidate_[c].match).feature).observations > 1 ? 1 : 0;
  return searched >= settings_.min_inliers && 2 * agree >= searched;
}

/// Corrects the body by the pose that the first `found` candidates say together, those without a depth as well.
void KeyframeTracking::fit_all(int found, const PosePrior& prior, Scalar median_depth) {
  int inliers = found;
  CameraPose pose = {prior.q_WC, prior.p_W};
  Mat6 information;
  {
    StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kGate]);
    int open = 0;
    for (int c = 0; c < found; ++c) open += map_.point(frame_.match(candidate_[c].match).feature).has_depth ? 0 : 1;
    for (int c = 0; c < found; ++c) {
      make_pose_match(c, prior, median_depth, open);
      if (has_rows()) pose_.match(c).point.pixel = followed_at_frame_time(frame_.match(candidate_[c].match));
    }
    inliers = pose_.fit(map_.camera(), found, prior, settings_.gate, &pose, &information);
  }
  Scalar shares = 0;
  for (int c = 0; c < found; ++c) shares += chance_share(agreeing_area(c), candidate_[c].searched);
  PosePrior at;
  if (inliers < settings_.min_inliers || !(is_believed(inliers, found, shares) || most_agree(found))) return;
  if (!apply(pose, information, &at)) return;
  for (int c = 0; c < found; ++c) {
    Match& match = frame_.match(candidate_[c].match);
    if (!pose_.is_inlier(c)) continue;
    ++frame_.report.inliers;
    accept(&match, followed_at_frame_time(match));
  }
}

int KeyframeTracking::follow(Scalar depth) {
  listed_ = 0;
  const PosePrior at = now();
  const int count = list(at, false, depth);
  int found = search_for(0, count, at, depth);
  if (2 * found < frame_.report.attempts && begin_following()) {
    frame_.forget_searches();
    found = search_for(0, list(at, false, depth), at, depth);
    is_following_ = false;
  }
  return found;
}

void KeyframeTracking::settle_followed(int found, const Quat& q_WC, const Vec3& p_W, Scalar depth) {
  using namespace tuning::keyframe_start;
  PosePrior about = {q_WC, p_W, Mat6(Mat6::Identity() * (kRotationSigma * kRotationSigma))};
  about.covariance.bottomRightCorner<3, 3>() = Mat3::Identity() * (kPositionSigma * kPositionSigma * depth * depth);
  about.v_W = motion_.body().v_W;
  about.w_C = motion_.body().w_C;
  for (int c = 0; c < found; ++c) {
    make_pose_match(c, about, depth, 0);
    if (has_rows()) pose_.match(c).point.pixel = followed_at_frame_time(frame_.match(candidate_[c].match));
  }
  CameraPose pose;
  Mat6 information;
  if (pose_.fit(map_.camera(), found, about, settings_.gate, &pose, &information) < settings_.min_inliers)
    pose = {q_WC, p_W};
  motion_.correct(pose.q_WC, pose.p_WC, about.covariance.cast<double>());
}

}  // namespace pf
