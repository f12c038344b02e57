#include "filter_slam/planes/plane_keeper.h"

#include <algorithm>
#include <cmath>

#include "frame/tuning.h"
#include "geometry/symmetric_eigen.h"
#include "model/camera_at.h"

/// Points of planes: unfold, fold, fix. Whole planes are in plane_lifecycle.cpp. Gee 2007, sections 3.3 and 3.4.

namespace pf {
namespace {

using namespace tuning::plane_keeper;

Scalar largest_eigenvalue(const Mat3& C) {
  Vec3 lambda;
  Mat3 V;
  symmetric_eigen(C, &lambda, &V);
  return lambda(2);
}

}  // namespace

bool PlaneKeeper::layout(Arena& arena, int max_features) {
  candidate_ = arena.take<PlaneCandidate>(static_cast<std::size_t>(max_features));
  told_ = nullptr;
  if (settings_.inertial) told_ = arena.take<Told>(static_cast<std::size_t>(map_.planes.capacity()));
  return places_.layout(arena, max_features);
}

void PlaneKeeper::maintain(bool may_doubt) {
  places_.update();
  judge_trials();
  unfold_outliers();
  filter_.scale_row(&scale_);
  const int turn = frame_.report.frames % map_.planes.capacity();
  for (int k = 0, maintained = 0; k < map_.planes.capacity(); ++k) {
    const int i = (turn + k) % map_.planes.capacity();
    if (!map_.planes.used(i) || map_.planes[i].apart) continue;
    ++map_.planes[i].age;
    // A wall that patches refuse does not wait for its turn: what begins on it misleads.
    if (may_doubt && map_.planes[i].is_refused_by_patches() && !map_.planes[i].doubted) judge_wall(i);
    if (maintained++ > 0) continue;
    judge_places(i);
    fold_into(i);
    if (map_.planes[i].known) {
      filter_.scale_row(&scale_);  // its points may be planar since
      fold_by_consensus(i);
      filter_.scale_row(&scale_);
      if (may_doubt) judge_wall(i);
    }
    settle_frame(i);
    PlaneOutline now;
    outline_plane(filter_, map_, i, &now);
    map_.planes[i].seen = now;
    if (settings_.fix_sigma > Scalar(0)) fix_on(i);
    merge_into(i);
  }
  dissolve_weak();
  if (frame_.report.frames % kDiscoverEvery != 0) return;
  filter_.scale_row(&scale_);  // its points may be gone or planar since
  discover();
}

/// Whether a feature is a converged 3-D point that was not found elsewhere since. That it was missed, or has left the view, says nothing
/// against its place. Points of the target are not folded: their place is known.
bool PlaneKeeper::is_converged(int entry) const {
  if (!map_.features.used(entry) || map_.features[entry].is_target) return false;
  const Feature& f = map_.features[entry];
  return filter_.state().block[f.slot].kind == BlockKind::kPoint && f.rejections == 0 && f.observations >= kConverged;
}

/// Whether it was found when it was last looked for as well. What decides about whole planes asks for that.
bool PlaneKeeper::is_settled(int entry) const { return is_converged(entry) && map_.features[entry].failures == 0; }

/// Whether a converged point is known well enough to be folded or to support a new plane. The covariance is relative to the camera and to
/// the global scale.
bool PlaneKeeper::is_certain(int entry, Mat3* covariance) const {
  *covariance = filter_.relative_covariance(map_.features[entry].slot, scale_);
  const Scalar limit = settings_.fold_sigma * settings_.fold_sigma;
  return (*covariance)(0, 0) + (*covariance)(1, 1) + (*covariance)(2, 2) < limit ||
         largest_eigenvalue(*covariance) < limit;
}

/// What this frame's pixel of a feature says of the plane on which it began, against a depth that is kTrialDepth smaller or larger:
///
///   z nearer to pi(p) than to either of pi(p_1 + (1 +- kTrialDepth) (p - p_1)),   p_1: the camera's place when it began
///
/// kOpen: there is no pixel, or the three are less than kTrialPixels apart.
PlaneKeeper::TrialVerdict PlaneKeeper::judge_depth(int entry) const {
  const Vec3 p_W = filter_.point(map_.features[entry].slot), first_W = map_.first_view(entry).c_W;
  const Match* match = nullptr;
  for (int t = 0; t < frame_.match_count() && match == nullptr; ++t)
    if (frame_.match(t).feature == entry && frame_.match(t).status == MatchStatus::kInlier) match = &frame_.match(t);
  if (match == nullptr) return TrialVerdict::kOpen;
  const bool rolls = filter_.lens().readout != Scalar(0) && filter_.state().layout.has(BodyPart::kVelocity);
  const CameraAt camera = camera_at(filter_.state(), rolls ? row_time(filter_.lens(), match->measured.y()) : Scalar(0));
  const auto pixel = [&](Scalar depth, Vec2* at) {
    const Vec3 moved_W = first_W + depth * (p_W - first_W);
    return project(filter_.lens(), Vec3(camera.q_WC.conjugate() * (moved_W - camera.p_W)), at);
  };
  Vec2 here, nearer, farther;
  if (!pixel(1, &here) || !pixel(1 - kTrialDepth, &nearer) || !pixel(1 + kTrialDepth, &farther))
    return TrialVerdict::kOpen;
  const Scalar apart2 = std::min((nearer - here).squaredNorm(), (farther - here).squaredNorm());
  if (apart2 <= kTrialPixels * kTrialPixels) return TrialVerdict::kOpen;
  const Scalar off2 = (match->measured - here).squaredNorm();
  const bool elsewhere =
      (match->measured - nearer).squaredNorm() < off2 || (match->measured - farther).squaredNorm() < off2;
  return elsewhere ? TrialVerdict::kElsewhere : TrialVerdict::kThere;
}

/// Features that began on a plane: believes those that were found there kTrialMatches times and from where another depth would show; drops
/// those that were found elsewhere kTrialRejections times in a row, or where another depth puts them. Their pixels are then free for a
/// feature of open depth.
void PlaneKeeper::judge_trials() {
  for (int i = 0; i < map_.features.capacity(); ++i) {
    if (!map_.features.used(i) || !map_.features[i].on_trial) continue;
    Feature& f = map_.features[i];
    const TrialVerdict verdict = judge_depth(i);
    if (f.rejections >= kTrialRejections || verdict == TrialVerdict::kElsewhere) {
      features_.drop(&i, 1);
    } else if (f.failures == 0 && f.observations > kTrialMatches && verdict == TrialVerdict::kThere) {
      f.on_trial = false;
      const int entry = map_.planes.entry_at(filter_.state().plane_of(f.slot));
      if (entry >= 0) support(entry, f.slot);
    }
  }
}

/// Unfolds points that were matched kMaxRejections times in a row outside of their gate, and inflates their plane.
void PlaneKeeper::unfold_outliers() {
  for (int i = 0; i < map_.features.capacity(); ++i) {
    if (!map_.features.used(i) || map_.features[i].rejections < kMaxRejections) continue;
    const int slot = map_.features[i].slot;
    if (!is_planar(filter_.state().block[slot].kind)) continue;
    const int plane = filter_.state().plane_of(slot);
    const int children = filter_.state().block[plane].children;
    if (!filter_.unfold(slot, kUnfoldSigma * settings_.plane_distance)) continue;
    map_.features[i].rejections = 0;
    map_.features[i].observations = 1;  // has to converge again before it may be folded
    inflate(plane, children);
    const int entry = map_.planes.entry_at(plane);
    if (entry < 0) continue;
    ++map_.planes[entry].outliers;
    // The outlier may have been a vertex: the outline starts again from the other points, or from the plan.
    map_.planes[entry].seen = map_.planes[entry].plan;
  }
}

/// Adds to the covariance of a plane what one point that was wrong by about plane_distance has done to it.
void PlaneKeeper::inflate(int plane_slot, int children) {
  const Vec3 sigma = doubt() / static_cast<Scalar>(std::max(children, 1));
  filter_.inflate(plane_slot, sigma.cwiseProduct(sigma).asDiagonal());
}

/// Standard deviation of (a, b, h) of a plane whose points were wrong by about plane_distance.
Vec3 PlaneKeeper::doubt() const {
  const Scalar extent = Scalar(0.25) * settings_.plane_radius;
  return Vec3(settings_.plane_distance / extent, settings_.plane_distance / extent, settings_.plane_distance);
}

/// Whether a point is near the known part of a plane; far from it, a point lies in the plane by chance. The paper limits the distance
/// from the plane's origin instead, since it has no variance for the distance of far points; here there is one.
bool PlaneKeeper::is_in_reach(int plane_entry, const Vec3& p_W) const {
  if (map_.planes[plane_entry].known) return is_before_wall(plane_entry, p_W);
  const PlaneFrame& frame = filter_.state().frame_of(filter_.state().block[map_.planes[plane_entry].slot]);
  const PlaneOutline& known = map_.planes[plane_entry].support;
  const Scalar reach = std::min(kReach * std::sqrt(outline_area(known)), settings_.plane_radius);
  return outline_contains(known, plane_coordinates(frame, p_W), reach);
}

/// Whether a point is near the plane, its distance is known, and it passes the gate of folding. A passed gate means little if the
/// variance of the distance is large, so that is bounded by plane_distance.
bool PlaneKeeper::lies_on(int plane, int slot) const {
  Scalar d, variance;
  if (!filter_.distance(plane, slot, &d, &variance)) return false;
  const int entry = map_.planes.entry_at(plane);
  const FoldRule rule = entry < 0 ? settings_.fold : fold_rule(entry);
  const Scalar limit = settings_.plane_distance * settings_.plane_distance;
  const Scalar noise = rule.roughness * rule.roughness;
  const Scalar near = entry >= 0 && map_.planes[entry].known ? limit + noise : limit;
  return d * d <= near * Scalar(4) && variance <= limit && d * d < rule.gate * (variance + noise);
}

/// Folds points that lie on the plane.
void PlaneKeeper::fold_into(int plane_entry) {
  const int plane = map_.planes[plane_entry].slot;
  const PlaneEntry& entry = map_.planes[plane_entry];
  if (entry.doubted) return;
  const Block& block = filter_.state().block[plane];
  const PlaneFrame& frame = filter_.state().frame_of(block);
  const FoldRule rule = fold_rule(plane_entry);
  const Scalar near = settings_.plane_distance + (entry.known ? rule.roughness : Scalar(0));
  int slots[Filter::kMaxFolded];
  int count = 0;
  for (int i = 0; i < map_.features.capacity() && count < Filter::kMaxFolded && count < settings_.max_observations;
       ++i) {
    if (!is_converged(i)) continue;
    const int slot = map_.features[i].slot;
    const Vec3 p_W = filter_.point(slot);
    if (!is_in_reach(plane_entry, p_W)) continue;
    if (std::abs(plane_distance(frame, block.xyz(), p_W)) > Scalar(2) * near) continue;
    Mat3 covariance;
    if (!lies_on(plane, slot) || !is_certain(i, &covariance)) continue;
    slots[count++] = slot;
  }
  unsigned char folded[Filter::kMaxFolded];
  if (count == 0 || filter_.fold(plane, slots, count, rule, folded) == 0) return;
  for (int i = 0; i < count; ++i)
    if (folded[i] != 0) support(plane_entry, slots[i]);
}

/// Extends a plane's support to a point that has been folded.
void PlaneKeeper::support(int plane_entry, int slot) {
  const State& state = filter_.state();
  const Vec2 uv = plane_coordinates(state.frame_of(state.block[map_.planes[plane_entry].slot]), filter_.point(slot));
  extend_outline(&map_.planes[plane_entry].support, &uv, 1);
}

/// Fixes points that are known well relative to the other points of their plane.
void PlaneKeeper::fix_on(int plane_entry) {
  const int plane = map_.planes[plane_entry].slot;
  const State& state = filter_.state();
  int group[Filter::kMaxFolded], slots[Filter::kMaxFolded];
  int group_count = 0, count = 0;
  const bool has_patch = filter_.group_of(plane) >= 0;
  state.for_each_planar(plane, [&](int slot) {
    const Block& block = state.block[slot];
    if (group_count == Filter::kMaxFolded || map_.features[block.owner].failures > 0) return;
    if (map_.features[block.owner].on_trial) return;
    if (block.kind == BlockKind::kPlanePoint) group[group_count++] = slot;
  });
  if (!has_patch && group_count < 2 * kMinFixed) return;
  const int limit = std::min(Filter::kMaxFolded, settings_.max_observations);
  const Scalar variance = settings_.fix_sigma * settings_.fix_sigma;
  for (int k = 0; k < group_count && count < limit; ++k)
    if (filter_.variance_in_group(group[k], group, group_count) < variance) slots[count++] = group[k];
  if (count == 0 || (!has_patch && count < kMinFixed)) return;
  filter_.fix(slots, count, settings_.fix, group, group_count);
}

}  // namespace pf
