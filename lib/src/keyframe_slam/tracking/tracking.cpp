#include "keyframe_slam/tracking/tracking.h"

#include <algorithm>
#include <cmath>

#include "base/elapsed.h"
#include "base/false_alarms.h"
#include "frame/ellipse.h"
#include "frame/feature_upkeep.h"
#include "frame/tuning.h"
#include "geometry/small_cholesky.h"
#include "geometry/symmetric_eigen.h"
#include "keyframe_slam/tracking/tuning.h"

namespace pf {

using namespace tuning::keyframe_tracking;

bool KeyframeTracking::layout(Arena& arena) {
  candidate_ = arena.take<Candidate>(static_cast<std::size_t>(settings_.max_features));
  pose_.layout(arena, settings_.max_features);
  return search_.layout(arena, settings_);
}

void KeyframeTracking::init() {
  search_.init(settings_);
  pose_.init();
  followed_.init();
  is_following_ = false;
  listed_ = found_ = 0;
}

Scalar KeyframeTracking::bound_px() const {
  return std::max(kBoundWidth * static_cast<Scalar>(settings_.camera.width), kBoundSigmas * noise_.sigma_gate());
}

bool KeyframeTracking::is_inside(const Vec2& pixel) const {
  const Scalar margin = static_cast<Scalar>(settings_.border_px);
  return !(pixel.x() < margin || pixel.y() < margin ||
           pixel.x() > static_cast<Scalar>(settings_.camera.width - 1) - margin ||
           pixel.y() > static_cast<Scalar>(settings_.camera.height - 1) - margin);
}

bool KeyframeTracking::expect_placed(int i, const PosePrior& at, ExpectedPixel* out) const {
  const KeyframePoint& point = map_.point(i);
  Mat26 J_C;
  Vec2 J_rho;
  if (!project_bearing(map_.camera(), at.q_WC.toRotationMatrix(), map_.ray_W(i),
                       map_.keyframes[point.host].p_W - at.p_W, point.rho, &out->pixel, &J_C, nullptr, &J_rho))
    return false;
  const Mat26 JP = J_C.lazyProduct(at.covariance);
  out->spread = JP.lazyProduct(J_C.transpose()) + point.variance * J_rho * J_rho.transpose();
  if (!has_rows()) return true;
  const Vec3 m = map_.ray_W(i) + point.rho * map_.keyframes[point.host].p_W;
  if (!expect_row(at, m, point.rho, out)) return false;
  out->spread += point.variance * J_rho * J_rho.transpose();
  return true;
}

/// Lists the points that should be in view, the most reliable first. Returns how many.
int KeyframeTracking::list(const PosePrior& at, bool placed, Scalar depth) {
  const int first = placed ? 0 : listed_;
  int count = 0;
  for (int i = 0; i < map_.capacity() && first + count < map_.capacity() && !frame_.full(); ++i) {
    if (!map_.used(i) || map_.point(i).has_depth != placed) continue;
    const Feature& f = map_.feature(i);
    ExpectedPixel expected;
    if (!f.has_appearance || (f.is_target && map_.tables().target_withdrawn)) continue;
    if (!(placed ? expect_placed(i, at, &expected) : expect_unplaced(i, at, depth, &expected))) continue;
    const Mat2 innovation = expected.spread + Mat2::Identity() * (kMapSigma * kMapSigma);
    if (!is_inside(expected.pixel) || !is_covariance(innovation)) continue;
    const int match = frame_.add(
        {i, f.id, MatchStatus::kMissed, map_.kind(i), false, expected.pixel, innovation, Vec2::Zero(), Scalar(0)});
    candidate_[first + count++] = {match, Mat2::Identity(), Scalar(0)};
  }
  std::sort(candidate_ + first, candidate_ + first + count, [&](const Candidate& a, const Candidate& b) {
    const Match &m = frame_.match(a.match), &n = frame_.match(b.match);
    const float of_a = reliability(map_.feature(m.feature)), of_b = reliability(map_.feature(n.feature));
    return of_a != of_b ? of_a > of_b : m.feature < n.feature;
  });
  return count;
}

/// Predicts candidates again, from a pose that is known better.
void KeyframeTracking::expect(int first, int count, const PosePrior& at) {
  for (int c = first; c < first + count; ++c) {
    Match& match = frame_.match(candidate_[c].match);
    ExpectedPixel expected;
    if (!expect_placed(match.feature, at, &expected)) continue;
    const Mat2 innovation = expected.spread + Mat2::Identity() * (kMapSigma * kMapSigma);
    if (!is_covariance(innovation)) continue;
    match.predicted = expected.pixel;
    match.innovation = innovation;
  }
}

SearchTask KeyframeTracking::task_of(int i, const PosePrior& at, Scalar depth) const {
  const KeyframePoint& point = map_.point(i);
  const Map& tables = map_.tables();
  const Keyframe& host = map_.keyframes[point.host];
  SearchTask task;
  task.appearance = &tables.appearance(i);
  task.first_view = point.faces_host ? CameraView{host.q_WC, host.p_W} : tables.first_view(i);
  if (tables.has_templates() && !tables.features[i].is_target && point.has_depth)
    ImageSearch::use_template(tables, i, &task);
  task.gate = settings_.gate;
  task.p_W = host.p_W + map_.ray_W(i) * (point.has_depth ? 1 / point.rho : depth);
  if (tables.features[i].is_target)
    task.normal_W = tables.target_normal_W;
  else if (point.has_depth && point.plane >= 0)
    task.normal_W = planes_.plane(point.plane).frame.R_WP.col(2);
  task.q_WC = at.q_WC;
  task.c_W = at.p_W;
  return task;
}

/// Searches for candidates, and moves those that are found to the front of their range. Returns how many.
int KeyframeTracking::search_for(int first, int count, const PosePrior& at, Scalar depth) {
  StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kSearch]);
  const Scalar image = static_cast<Scalar>(settings_.camera.width) * static_cast<Scalar>(settings_.camera.height);
  int found = first;
  for (int c = first; c < first + count; ++c) {
    Match& match = frame_.match(candidate_[c].match);
    SearchTask task = task_of(match.feature, at, depth);
    task.predicted = match.predicted;
    task.innovation = match.innovation;
    if (settings_.gate * symmetric_eigenvalues(match.innovation)(1) > kTemplateEllipse * kTemplateEllipse)
      task.shape = nullptr;
    if (is_following_ && !aim(match.feature, &task)) continue;
    const SearchOutcome outcome = search_.search(task);
    if (!outcome.comparable) continue;
    match.searched = true;
    ++frame_.report.attempts;
    if (!outcome.found || squared_distance(outcome.pixel - match.predicted, match.innovation) > settings_.gate)
      continue;
    ++frame_.report.matches;
    match.measured = outcome.pixel;
    match.status = MatchStatus::kOutlier;  // until the consensus says otherwise
    candidate_[c].noise = noise_.match(outcome.noise, outcome.level_scale);
    candidate_[c].searched = std::min(image, ellipse_area(task.innovation, settings_.gate));
    std::swap(candidate_[found++], candidate_[c]);
  }
  return found - first;
}

/// A candidate as a match for the pose: m = R r + rho p_host, w = rho. Without a depth it has the median one, and as much again as standard
/// deviation; its noise has that times the baseline, the prior's and the uncertain part of it:
///
///   R += var(rho) (J_rho J_rhoᵀ + J_p P_p J_pᵀ / rho²)
///
/// shared: points without a depth in the fit, which may all be nearer or farther together, so that their mean is no better known than one;
/// 0: their median is the unit of length, and each is wrong by itself.
void KeyframeTracking::make_pose_match(int c, const PosePrior& prior, Scalar depth, int shared) {
  const Match& match = frame_.match(candidate_[c].match);
  const KeyframePoint& point = map_.point(match.feature);
  const Vec3& host_W = map_.keyframes[point.host].p_W;
  const Vec3 ray_W = map_.ray_W(match.feature);
  const Scalar rho = point.has_depth ? point.rho : 1 / depth;
  const Scalar variance = point.has_depth ? point.variance : static_cast<Scalar>(std::max(shared, 1)) * rho * rho;
  Vec2 z, J_rho;
  Mat26 J_C;
  PoseMatch& out = pose_.match(c);
  out.point = {ray_W + rho * host_W, rho, match_at_frame_time(match, prior, depth)};
  out.noise = noise_.correlation_frames() * candidate_[c].noise;
  if (project_bearing(map_.camera(), prior.q_WC.toRotationMatrix(), ray_W, host_W - prior.p_W, rho, &z, &J_C, nullptr,
                      &J_rho)) {
    out.noise += variance * J_rho * J_rho.transpose();
    if (point.has_depth || shared == 0) return;
    const Mat23 J_p = J_C.rightCols<3>() / rho;
    const Mat3 P_p = prior.covariance.bottomRightCorner<3, 3>();
    out.noise += variance * J_p.lazyProduct(P_p).lazyProduct(J_p.transpose());
  }
}

/// Pose that the first `found` candidates support. Returns the number of inliers, 0 where the pose may be chance.
int KeyframeTracking::find_pose(int found, const PosePrior& prior, CameraPose* pose, Mat6* information) {
  StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kGate]);
  for (int c = 0; c < found; ++c) make_pose_match(c, prior, Scalar(1), 0);
  const int inliers = pose_.find(map_.camera(), found, prior, bound_px(), settings_.min_inliers, pose, information);
  const Scalar circle = ellipse_area(Mat2::Identity() * (bound_px() * bound_px()), Scalar(1));
  Scalar shares = 0;
  for (int c = 0; c < found; ++c) shares += chance_share(circle, candidate_[c].searched);
  return is_believed(inliers, found, shares) ? inliers : 0;
}

/// Probability that a search finds something by chance, and within this area [px^2].
Scalar KeyframeTracking::chance_share(Scalar area, Scalar searched) {
  using namespace tuning::chance;
  return kMaxFindShare * std::min(Scalar(1), area / std::max(searched, kMinArea));
}

/// Half of what was searched for agrees, or far more than chance would give: with n of m matches within the bound, by chance each with its
/// chance_share(); shares: their sum.
bool KeyframeTracking::is_believed(int inliers, int found, Scalar shares) const {
  using namespace tuning::chance;
  if (inliers == 0) return false;
  if (2 * inliers >= frame_.report.attempts) return true;
  const Scalar share = std::clamp(shares / static_cast<Scalar>(found), kMinShare, kMaxShare);
  return log_false_alarms(inliers, frame_.report.attempts, share, found) < tuning::tracking::kMaxLogFalse;
}

/// Says of each match whether it is where the pose has it, within its own noise and that of the pose.
void KeyframeTracking::mark(int found, const PosePrior& at) {
  for (int c = 0; c < found; ++c) {
    Match& match = frame_.match(candidate_[c].match);
    ExpectedPixel expected;
    match.status = MatchStatus::kOutlier;
    if (!pose_.is_inlier(c) || !expect_placed(match.feature, at, &expected)) continue;
    const Vec2 r = match.measured - expected.pixel;
    match.nis = squared_distance(r, Mat2(candidate_[c].noise + expected.spread));
    const Mat2 S = candidate_[c].noise + NoiseModel::search() + expected.spread;
    if (squared_distance(r, S) > settings_.gate) continue;
    frame_.report.nis += static_cast<double>(match.nis);
    frame_.report.nis_dof += 2;
    ++frame_.report.inliers;
    accept(&match);
  }
}

void KeyframeTracking::accept(Match* match, const Vec2& pixel) {
  match->status = MatchStatus::kInlier;
  Feature& f = map_.feature(match->feature);
  if (has_rows() && is_seen_again(*match)) correct_first_pixel(*match);
  count_frame(&f.observations);
  f.failures = 0;
  f.rejections = 0;
  f.last_seen_ns = frame_.report.t_ns;
  KeyframePoint& point = map_.point(match->feature);
  point.pixel = pixel;
  point.seen_from = {motion_.body().q_WC, motion_.body().p_W};
}

int KeyframeTracking::measure_about(const PosePrior& about, CameraPose* pose, Mat6* information) {
  listed_ = list(about, true, Scalar(1));
  Scalar widest = 0;
  for (int c = 0; c < listed_; ++c)
    widest = std::max(widest, symmetric_eigenvalues(frame_.match(candidate_[c].match).innovation)(1));
  const bool wide = settings_.gate * widest > kWideEllipse * kWideEllipse && listed_ > kScouts;
  int found = search_for(0, wide ? kScouts : listed_, about, Scalar(1));
  int inliers = 0;
  PosePrior moving = about;  // with the velocities that are known best
  if (wide) {
    // A few first: with their pose the others are searched for in small ellipses.
    PosePrior scouted = about;
    inliers = find_pose(found, about, pose, information);
    SmallCholesky<6> factored, prior;
    KeyframeMotion after = motion_;
    if (inliers > 0 && has_rows() && about.with_velocities != nullptr &&
        follow_velocities(*pose, *information, &after)) {
      scouted = {pose->q_WC,       pose->p_WC,       after.pose_covariance(),
                 after.body().v_W, after.body().w_C, &after.covariance()};
      expect(kScouts, listed_ - kScouts, scouted);
    } else if (inliers > 0 && prior.factor(about.covariance) && factored.factor(Mat6(*information + prior.inverse()))) {
      scouted = {pose->q_WC, pose->p_WC, factored.inverse(), about.v_W, about.w_C};
      expect(kScouts, listed_ - kScouts, scouted);
    }
    const int more = search_for(kScouts, listed_ - kScouts, scouted, Scalar(1));
    for (int k = 0; k < more; ++k, ++found)
      if (found != kScouts + k) std::swap(candidate_[found], candidate_[kScouts + k]);
    moving.v_W = scouted.v_W;
    moving.w_C = scouted.w_C;
  }
  found_ = found;
  return find_pose(found, moving, pose, information);
}

}  // namespace pf
