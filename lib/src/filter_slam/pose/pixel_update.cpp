#include "filter_slam/pose/pixel_update.h"

#include <algorithm>
#include <cmath>

#include "base/elapsed.h"
#include "base/limits.h"
#include "base/table_entries.h"
#include "filter_slam/pose/consensus.h"
#include "filter_slam/pose/tuning.h"
#include "geometry/so3.h"

namespace pf {
namespace {

constexpr int kMaxRounds = 3;                ///< of relinearisation
constexpr int kOldest = 255;                 ///< [frames] that are distinguished
constexpr Scalar kOpenDepth = Scalar(0.1);   ///< relative sigma from which a depth is open, and comes first
constexpr Scalar kMaxFirstNis = Scalar(30);  ///< chi-square of six, 1 - 4e-5: pixels contradict such a pose
constexpr Scalar kMinBend = Scalar(1e-6);    ///< [px^2] that R^2 is divided by

}  // namespace

bool PixelUpdate::layout(Arena& arena, int max_observations) {
  const std::size_t count = static_cast<std::size_t>(max_observations);
  candidate_ = arena.take<Candidate>(count);
  observation_ = arena.take<PixelMeasurement>(count);
  keep_ = arena.take<unsigned char>(2 * count);
  scratch_ = keep_ != nullptr ? keep_ + count : nullptr;
  others_.layout(arena, max_observations);
  return arena.ok();
}

void PixelUpdate::begin(int first, int count) {
  StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kUpdate]);
  filter_.begin_update(observation_ + first, count);
}

int PixelUpdate::reject_contradicted(int first, int count, JointFit* fit) {
  *fit = JointFit();
  for (int i = 0; i < count; ++i) {
    const Feature& feature = map_.features[candidate_[first + i].feature];
    scratch_[i] = static_cast<unsigned char>(feature.is_target ? kOldest : std::min(feature.observations, kOldest));
  }
  others_.reject(filter_, observation_ + first, count, tuning::pixel_update::kOthersGate * settings_.gate,
                 {scratch_, settings_.min_inliers}, keep_ + first, fit);
  return static_cast<int>(std::count(keep_ + first, keep_ + first + count, static_cast<unsigned char>(1)));
}

/// A point that began at a wall is correlated with it, but may stand before it. Until it is folded into a plane its pixels update the
/// camera and its own depth, and the walls are considered: all points before a wall would move it the same way.
///
/// walls: kMaxPlanes slots
PartlyConsidered PixelUpdate::undecided_walls(int first, int count, int* walls) {
  PartlyConsidered partly;
  int undecided = 0;
  for (int i = 0; i < count; ++i) {
    const Feature& feature = map_.features[candidate_[first + i].feature];
    const bool tells = !feature.began_by_wall || is_planar(filter_.state().block[feature.slot].kind);
    scratch_[i] = tells ? 1 : 0;
    undecided += tells ? 0 : 1;
  }
  if (undecided == 0) return partly;
  for (const int k : used_entries(map_.planes))
    if (map_.planes[k].known && map_.planes[k].counts()) walls[partly.count++] = map_.planes[k].slot;
  partly.block = walls;
  partly.estimates = scratch_;
  return partly;
}

/// Of most of the kept ones, in metres.
bool PixelUpdate::are_depths_open(int first, int count) const {
  int open = 0, all = 0;
  for (int i = first; i < first + count; ++i) {
    if (keep_[i] == 0) continue;
    const int slot = map_.features[candidate_[i].feature].slot;
    const Block& block = filter_.state().block[slot];
    ++all;
    if (block.kind == BlockKind::kInverseDepth)
      open += !(std::sqrt(filter_.block_variance(slot, 2)) < kOpenDepth * block.inverse_depth().rho);
  }
  return tuning::pixel_update::kMinOpen * open > all;
}

Scalar PixelUpdate::propose(int first, int count, EstimatedRows rows, Scalar depth, Scalar before, Scalar evidence) {
  const bool solved = filter_.solve_update(observation_ + first, count, keep_ + first, nullptr, rows);
  const Scalar* dx = filter_.solved_step();
  const Body& body = filter_.state().body;
  const Vec3 e_theta(dx[Body::kTheta], dx[Body::kTheta + 1], dx[Body::kTheta + 2]);
  const Vec3 e_p(dx[Body::kPosition], dx[Body::kPosition + 1], dx[Body::kPosition + 2]);
  filter_.begin_update(observation_ + first, count);  // what was gathered is used up by solving
  if (!solved) return before;
  return proposals_.propose(exp_so3(e_theta) * body.q_WC, body.p_W + e_p, depth, before, evidence);
}

UpdateOutcome PixelUpdate::apply(int first, int count, const UpdateMode& mode, const UpdateOutcome& before) {
  StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kUpdate]);
  UpdateOutcome now = before;
  bool depths_only = mode.depths_first && !before.is_pose_open && are_depths_open(first, count);
  int walls[kMaxPlanes];
  EstimatedRows rows = {mode.rows.motion && !depths_only, mode.rows.map, undecided_walls(first, count, walls)};
  Scalar sum = 0, pose_nis = 0, of_rotation = 0;
  bool solved = filter_.solve_update(observation_ + first, count, keep_ + first, &sum, rows);
  const bool says_pose = solved && settings_.inertial && filter_.pose_nis(&pose_nis, &of_rotation);
  if (says_pose && depths_only && pose_nis > kMaxFirstNis) {
    now.is_pose_open = true;
    depths_only = false;
    rows.motion = mode.rows.motion;
    filter_.begin_update(observation_ + first, count);
    solved = filter_.solve_update(observation_ + first, count, keep_ + first, &sum, rows);
  }
  if (says_pose && mode.max_pose_nis > Scalar(0) && frame_.report.inliers == 0 && pose_nis > mode.max_pose_nis)
    now.is_contradicted = true;
  if (!now.is_contradicted) tracking_.note_update(solved);
  now.is_applied = solved && !now.is_contradicted;
  now.nis = now.is_applied ? static_cast<double>(sum) : 0;
  if (!now.is_applied) {
    reject(first, count);
    return now;
  }
  filter_.commit_update();
  // While depths come first the pose's error stays, so frames are not independent evidence against the samples.
  if (says_pose && !depths_only) {
    frame_.report.pose.nis += static_cast<double>(pose_nis);
    frame_.report.pose.of_rotation += static_cast<double>(of_rotation);
    frame_.report.pose.dof += Body::kPoseDim;
  }
  count_inliers(first, count);
  relinearise_update(first, count, rows);
  return now;
}

void PixelUpdate::count_inliers(int first, int count) {
  for (int i = first; i < first + count; ++i) {
    if (keep_[i] == 0) continue;
    frame_.report.nis_dof += 2;
    ++frame_.report.inliers;
    Feature& feature = map_.features[candidate_[i].feature];
    // A frame that is measured again, without a prediction that led it astray, counts once.
    if (feature.last_seen_ns != frame_.report.t_ns) count_frame(&feature.observations);
    feature.rejections = 0;
    feature.last_seen_ns = frame_.report.t_ns;
  }
}

void PixelUpdate::reject(int first, int count) {
  for (int i = first; i < first + count; ++i) frame_.match(candidate_[i].match).status = MatchStatus::kOutlier;
}

/// Over an angle of s = sqrt(lambda / f^2) the linearisation neglects about f s^2 pixels; as noise, f^2 s^4 / 2. lambda is the smaller
/// eigenvalue: the larger one may come from depth, in which an inverse-depth point is linear.
Mat2 PixelUpdate::expected_innovation(PixelMeasurement* o) const {
  const Mat2 S = filter_.innovation(*o);
  const Scalar half = (S(0, 0) - S(1, 1)) / 2;
  const Scalar lambda = (S(0, 0) + S(1, 1)) / 2 - std::sqrt(half * half + S(0, 1) * S(0, 1));
  const Scalar bend = lambda * lambda / (2 * filter_.lens().fx * filter_.lens().fy);
  o->bend = bend;
  return S;
}

/// If second-order noise was large in the update, linearises the same pixels again at the updated pose and updates with the information
/// that this noise had withheld:  R' = (R^-1 - (R + bend I)^-1)^-1 = R + R^2 / bend. Those whose place the update has thrown out of their
/// gate are left out.
void PixelUpdate::relinearise_update(int first, int count, EstimatedRows rows) {
  for (int round = 0; round < kMaxRounds; ++round) {
    bool bent = false;
    for (int i = first; i < first + count; ++i)
      bent = bent || (keep_[i] != 0 && 2 * observation_[i].bend > observation_[i].R_update(0, 0));
    if (!bent) return;
    for (int i = first; i < first + count; ++i) {
      if (keep_[i] == 0) continue;
      PixelMeasurement& o = observation_[i];
      const Vec2 measured = o.measured;
      const Scalar bend = std::max(o.bend, kMinBend);
      const Mat2 R = o.R_straight;
      keep_[i] = filter_.predict_pixel(filter_.lens(), o.block, &o) ? 1 : 0;
      if (keep_[i] == 0) continue;
      const Mat2 spread = expected_innovation(&o);
      o.measured = measured;
      o.set_noise(R + R.lazyProduct(R) / bend);
      keep_[i] = squared_distance(o.measured - o.predicted, spread + o.R_update) < settings_.gate ? 1 : 0;
    }
    filter_.begin_update(observation_ + first, count);
    if (!filter_.finish_update(observation_ + first, count, keep_ + first, nullptr, rows)) return;
  }
}

}  // namespace pf
