#include "keyframe_slam/tracking/keyframe_tracking.h"

#include <cmath>
#include <limits>

#include "base/elapsed.h"
#include "frame/ellipse.h"
#include "frame/tuning.h"
#include "geometry/small_cholesky.h"
#include "geometry/so3.h"
#include "keyframe_slam/map/depth.h"
#include "keyframe_slam/map/rows.h"
#include "keyframe_slam/tracking/body_correction.h"
#include "keyframe_slam/tracking/frame_time.h"
#include "keyframe_slam/tracking/tuning.h"

namespace pf {

using namespace tuning::keyframe_tracking;

void KeyframeTracking::measure(Scalar median_depth) {
  PosePrior prior = prior_of(motion_);
  CameraPose pose = {prior.q_WC, prior.p_W};
  Mat6 information = Mat6::Zero();
  hypotheses_.begin();
  if (!measure_placed(prior, &pose, &information)) {
    if (motion_.max_nis() > Scalar(0)) return;
    measure_all(prior, median_depth);
    if (frame_.report.inliers > 0 || !search_.find_followed()) return;
    frame_.forget_searches();
    hypotheses_.add();
    prior.follows = true;
    if (!measure_placed(prior, &pose, &information)) return measure_all(prior, median_depth);
  }
  const bool corrected =
      has_rows(map_.camera()) ? correct_by_rows(prior, pose, information) : correct(pose, information);
  if (corrected) measure_unplaced(median_depth);
}

/// Finds points with a depth about the predicted pose. False where their evidence is not enough to accept the pose, or another prediction
/// is to be tried.
bool KeyframeTracking::measure_placed(const PosePrior& prior, CameraPose* pose, Mat6* information) {
  PoseConsensus consensus;
  const bool has_other = motion_.max_nis() > Scalar(0), is_second = first_.t_ns == frame_.report.t_ns;
  if (!is_second) first_ = {frame_.report.t_ns, std::numeric_limits<Scalar>::lowest()};
  if (measure_about(prior, pose, information, &consensus) == 0) return false;
  if (has_other) {
    const Scalar evidence = belief_.evidence(consensus);
    const bool are_few = belief_.share().is_unlikely(consensus.searched, consensus.inliers);
    if (is_second && are_few && !(evidence > first_.evidence)) return false;
    if (!is_second && (are_few || contradicts(*pose, *information))) {
      first_.evidence = evidence;
      return false;
    }
  }
  return is_believed(consensus);
}

/// A prediction that is as far from the pose as hardly ever by chance: it has pulled the pose, and left out points.
bool KeyframeTracking::contradicts(const CameraPose& pose, const Mat6& information) const {
  KeyframeMotion after = motion_;
  PosePrior now;
  if (!correct_body(pose, information, &after, &now) || !after.measured().is_set) return false;
  const KeyframeMotion::MeasuredPose& measured = after.measured();
  const Body& predicted = motion_.body();
  Vec6 e;
  e << log_so3(measured.q_WC * predicted.q_WC.conjugate()), measured.p_W - predicted.p_W;
  SmallCholesky<6> S;
  return S.factor(Mat6(motion_.pose_covariance() + noise_.correlation_frames() * measured.R)) &&
         e.dot(S.solve<1>(e)) > motion_.max_nis();
}

/// Weighs what was found about the prediction.
bool KeyframeTracking::is_believed(const PoseConsensus& consensus) {
  const Scalar log_odds = hypotheses_.weigh(consensus);
  if (!hypotheses_.accepts(consensus, log_odds)) {
    belief_.note(log_odds);
    return false;
  }
  belief_.use(log_odds, consensus);
  return true;
}

int KeyframeTracking::measure_about(const PosePrior& about, CameraPose* pose, Mat6* information,
                                    PoseConsensus* consensus) {
  const int listed = search_.list_placed(about);
  PosePrior moving = about;  // with the velocities that are known best
  const bool is_wide = settings_.gate * search_.widest(listed) > kWideEllipse * kWideEllipse;
  if (is_wide && listed > kScouts)
    found_ = search_by_scouts(about, pose, information, &moving);
  else
    found_ = search_.search(0, 0, listed, about, Scalar(1));
  int inliers = pose_.find(found_, moving, pose, information);
  if (is_wide && inliers > 0 && search_.has_image() && look_again(about, pose, information, &moving))
    inliers = pose_.find(found_, moving, pose, information);
  *consensus = pose_.consensus(inliers, found_, about, *pose, *information);
  note_paired(frame_, belief_.share(), consensus);
  if (inliers > 0) pose_.weigh_lens(found_, *pose, consensus);
  frame_.note_consensus(inliers);
  return inliers;
}

/// The prior of searches after the first matches have given a pose, with the velocities that follow from it. False: it has no covariance.
bool KeyframeTracking::narrow(const PosePrior& about, const CameraPose& pose, const Mat6& information,
                              KeyframeMotion* after, PosePrior* out) const {
  SmallCholesky<6> factored, prior;
  if (has_rows(map_.camera()) && about.with_velocities != nullptr && follow_velocities(pose, information, after)) {
    *out = {pose.q_WC, pose.p_WC, after->pose_covariance(), after->body().v_W, after->body().w_C, &after->covariance()};
    return true;
  }
  if (!prior.factor(about.covariance) || !factored.factor(Mat6(information + prior.inverse()))) return false;
  *out = {pose.q_WC, pose.p_WC, factored.inverse(), about.v_W, about.w_C};
  return true;
}

/// Searches for a few points first: with their pose the others are searched for in small ellipses. moving gets the velocities that follow
/// from it. Returns how many are found.
int KeyframeTracking::search_by_scouts(const PosePrior& about, CameraPose* pose, Mat6* information, PosePrior* moving) {
  const int others = search_.placed() - kScouts;
  const int found = search_.search(0, 0, kScouts, about, Scalar(1));
  PosePrior scouted = about;
  int inliers = pose_.find(found, about, pose, information);
  if (!PoseBelief::is_enough(belief_.evidence(pose_.consensus(inliers, found, about, *pose, *information))))
    inliers = 0;
  KeyframeMotion after = motion_;
  if (inliers > 0 && narrow(about, *pose, *information, &after, &scouted))
    search_.predict_again(kScouts, others, scouted);
  scouted.follows = about.follows;
  moving->v_W = scouted.v_W;
  moving->w_C = scouted.w_C;
  return search_.search(found, kScouts, others, scouted, Scalar(1));
}

/// In a wide ellipse a texture that repeats hides its point. So what does not agree with the pose that the others give is searched for once
/// more, in the small ellipse about that pose. False where that has no covariance; nothing is searched for then.
bool KeyframeTracking::look_again(const PosePrior& about, CameraPose* pose, Mat6* information, PosePrior* moving) {
  PosePrior at = about;
  KeyframeMotion after = motion_;
  if (!narrow(about, *pose, *information, &after, &at)) return false;
  const int kept = search_.forget_others(found_, pose_.inliers());
  const int others = search_.placed() - kept;
  search_.predict_again(kept, others, at);
  moving->v_W = at.v_W;
  moving->w_C = at.w_C;
  found_ = search_.search(kept, kept, others, at, Scalar(1));
  return true;
}

/// Pixels at the frame's time were found with the predicted velocities; after a jerk the pose is found once more, with the velocities that
/// the pose implies.
bool KeyframeTracking::correct_by_rows(const PosePrior& before, CameraPose pose, Mat6 information) {
  const int found = frame_.report.matches;
  for (int pass = 0; pass < kRowPasses; ++pass) {
    KeyframeMotion after = motion_;
    if (!follow_velocities(pose, information, &after)) break;
    PosePrior at = before;
    at.v_W = after.body().v_W;
    at.w_C = after.body().w_C;
    if (pose_.find(found, at, &pose, &information) > 0) continue;
    pose_.find(found, before, &pose, &information);  // the consensus of before counts
    break;
  }
  return correct(pose, information);
}

bool KeyframeTracking::correct(const CameraPose& pose, const Mat6& information) {
  const KeyframeMotion before = motion_;
  PosePrior now;
  if (!apply(pose, information, &now)) return false;
  if (mark(now) >= settings_.min_inliers) {
    accept_marked();
    return true;
  }
  for (int c = 0; c < frame_.report.matches; ++c) search_.match(c).status = MatchStatus::kOutlier;
  motion_.set_prediction(before.body(), before.covariance());
  return false;
}

bool KeyframeTracking::apply(const CameraPose& pose, const Mat6& information, PosePrior* now) {
  StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kUpdate]);
  return correct_body(pose, information, &motion_, now);
}

/// Marks each match as inlier or outlier of the pose, within its own noise and that of the pose. Returns the number of inliers.
int KeyframeTracking::mark(const PosePrior& at) {
  const int found = frame_.report.matches;
  int inliers = 0;
  for (int c = 0; c < found; ++c) {
    Match& match = search_.match(c);
    const Mat2& noise = search_.point(c).noise;
    ExpectedPixel expected;
    match.status = MatchStatus::kOutlier;
    if (!pose_.is_inlier(c) || !expect_placed(map_, match.feature, at, &expected)) continue;
    const Vec2 r = match.measured - expected.pixel;
    match.nis = squared_distance(r, Mat2(noise + expected.spread));
    const Mat2 S = noise + NoiseModel::search() + expected.spread;
    if (squared_distance(r, S) > settings_.gate) continue;
    match.status = MatchStatus::kInlier;
    ++inliers;
  }
  return inliers;
}

void KeyframeTracking::accept_marked() {
  const int found = frame_.report.matches;
  const PosePrior now = prior_of(motion_);
  for (int c = 0; c < found; ++c) {
    Match& match = search_.match(c);
    if (match.status != MatchStatus::kInlier) continue;
    frame_.report.nis += static_cast<double>(match.nis);
    frame_.report.nis_dof += 2;
    ++frame_.report.inliers;
    accept(match_at_frame_time(map_, match, now, Scalar(1)), &match);
  }
}

void KeyframeTracking::accept(const Vec2& pixel, Match* match) {
  accept_match(motion_.view(), pixel, frame_.report.t_ns, &map_, match);
}

/// Points without a depth: where the corrected pose leaves no depth that explains their pixel, it is wrong.
void KeyframeTracking::measure_unplaced(Scalar depth) {
  const PosePrior at = prior_of(motion_);
  const int count = search_.list_unplaced(at, depth), first = search_.placed();
  const int end = search_.search(first, first, count, at, depth);
  for (int c = first; c < end; ++c) {
    Match& match = search_.match(c);
    const Vec2 pixel = match_at_frame_time(map_, match, at, depth);
    DepthFit fit;
    const bool fits = fit_depth(map_.camera(), map_, match.feature, {at.q_WC, at.p_W}, pixel, &fit);
    if (fits ? fit.worst_px > pose_.bound_px() : fit.cos_parallax < std::cos(kMaxParallel)) continue;
    accept(pixel, &match);
  }
}

void KeyframeTracking::measure_young(Scalar median_depth) {
  const PosePrior prior = prior_of(motion_);
  hypotheses_.begin();
  const int placed = search_.list_placed(prior);
  const int count = placed + search_.list_unplaced(prior, median_depth);
  fit_all(search_.search(0, 0, count, prior, median_depth), prior, median_depth);
}

/// After measure_about() found no pose: the points without a depth are searched for as well.
void KeyframeTracking::measure_all(const PosePrior& prior, Scalar median_depth) {
  const int count = search_.list_unplaced(prior, median_depth);
  fit_all(search_.search(found_, search_.placed(), count, prior, median_depth), prior, median_depth);
}

/// Updates the body with the pose fitted to the first `found` points, those without a depth as well.
void KeyframeTracking::fit_all(int found, const PosePrior& prior, Scalar median_depth) {
  CameraPose pose = {prior.q_WC, prior.p_W};
  Mat6 information;
  int open = 0;
  for (int c = 0; c < found; ++c) open += map_.point(search_.match(c).feature).has_depth ? 0 : 1;
  const int inliers = pose_.fit(found, prior, median_depth, open, &pose, &information);
  PosePrior at;
  PoseConsensus consensus = pose_.consensus(inliers, found, prior, pose, information);
  note_paired(frame_, belief_.share(), &consensus);
  if (inliers > 0) pose_.weigh_lens(found, pose, &consensus);
  if (!is_believed(consensus) || !apply(pose, information, &at)) return;
  for (int c = 0; c < found; ++c) {
    Match& match = search_.match(c);
    if (!pose_.is_inlier(c)) continue;
    ++frame_.report.inliers;
    accept(followed_at_frame_time(map_, match, frame_.report.t_ns), &match);
  }
}

void KeyframeTracking::learn_noise() {
  const PosePrior at = prior_of(motion_);
  for (int c = 0; c < search_.placed(); ++c) {
    const Match& match = search_.match(c);
    const Mat2& noise = search_.point(c).noise;
    ExpectedPixel expected;
    if (match.status != MatchStatus::kInlier || match.feature < 0) continue;
    Feature& f = map_.feature(match.feature);
    if (f.observations < tuning::image_front_end::kSettled || !expect_placed(map_, match.feature, at, &expected))
      continue;
    const Scalar leverage = expected.spread.trace() / (noise_.correlation_frames() * noise.trace());
    noise_.learn(frame_.report.frames, match.measured - expected.pixel, noise, leverage,
                 f.is_target ? nullptr : &f.residuals);
  }
  noise_.end_frame();
}

}  // namespace pf
