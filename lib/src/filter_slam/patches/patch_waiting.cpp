#include <algorithm>
#include <cmath>

#include "filter_slam/features/wall_rays.h"
#include "filter_slam/patches/patch_keeper.h"
#include "filter_slam/patches/tuning.h"
#include "frame/followed_view.h"
#include "geometry/common_ratio.h"
#include "geometry/homography.h"
#include "geometry/ray_plane.h"
#include "model/camera_at.h"
#include "model/reference_camera.h"

/// Which plane a patch lies on: until that is known it is followed, and is no measurement (lib/docs/walls.md). Servant 2008, section 2.5

namespace pf {
namespace {

using namespace tuning::patch_waiting;
using model::ReferenceCamera;

constexpr int kMaxMost = 128;  // points that are asked

}  // namespace

/// Where a waiting patch is: as the plane has it that explains the last frame, or else where it was, rotated with the camera.
bool PatchKeeper::expect_waiting(const StoredPatch& patch, Sight* sight) const {
  const std::uint32_t likely = patch.is_proven() ? patch.wait.likely() : patch.plane;
  for (int k = 0; k < map_.planes.capacity() && likely != 0; ++k)
    if (map_.planes.used(k) && map_.planes[k].id == likely && map_.planes[k].counts() && expect(patch, k, sight))
      return true;
  const Camera& lens = filter_.lens();
  const Quat q_now_last = filter_.state().body.q_WC.conjugate() * q_last_;
  Vec3 from[4], to[4], ray;
  for (int k = 0; k < 4; ++k) {
    if (!unproject(lens, patch.corner[k], &ray) || !project(lens, Vec3(q_now_last * ray), &sight->corner[k]) ||
        !unproject(lens, patch.pixels.corner(k), &from[k]) || !unproject(lens, sight->corner[k], &to[k]))
      return false;
  }
  sight->cosine = 0;
  return homography_from_4(from, to, &sight->H_CK);
}

/// Whether a plane's outline holds the patch's middle as its reference camera saw it. What was found may be larger than what is known of
/// it.
bool PatchKeeper::may_lie_on(const StoredPatch& patch, int entry, Scalar* range) const {
  const PlaneEntry& plane = map_.planes[entry];
  if (!map_.planes.used(entry) || !plane.counts()) return false;
  const State& state = filter_.state();
  const Block& camera = state.block[patch.camera];
  Vec3 ray_K;
  const Vec2 middle =
      (patch.reference_px[0] + patch.reference_px[1] + patch.reference_px[2] + patch.reference_px[3]) / 4;
  if (!unproject(filter_.lens(), middle, &ray_K)) return false;
  const Vec3 p_W = ReferenceCamera::p_WC(camera), ray_W = ReferenceCamera::q_WC(camera) * ray_K;
  if (plane.known) return meets_wall(filter_, map_, entry, p_W, ray_W, range);
  const Block& block = state.block[plane.slot];
  const PlaneFrame& frame = state.frame_of(block);
  Vec3 hit_W;
  if (plane.support.count < 3 || !(plane_distance(frame, block.xyz(), p_W) > Scalar(0)) ||
      !intersect_ray_plane(frame, block.xyz(), p_W, ray_W, &hit_W))
    return false;
  *range = (hit_W - p_W).norm() / ray_W.norm();
  return outline_contains(plane.support, plane_coordinates(frame, hit_W),
                          kReach * std::sqrt(outline_area(plane.support)));
}

/// Tries the planes that the patch may lie on, at most kMaxTrials. counts: what this frame says is kept. Returns the nearest one that
/// passes, or -1.
int PatchKeeper::try_planes(StoredPatch* patch, bool counts) {
  int nearest = -1, tried = 0;
  Scalar least = 0;
  for (int k = 0; k < map_.planes.capacity() && tried < PatchWait::kMaxTrials; ++k) {
    Scalar range;
    const int plane = map_.planes[k].slot;
    if (!may_lie_on(*patch, k, &range) ||
        !filter_.predict_patch(filter_.lens(), patch->block, plane, patch->reference_px, &z_))
      continue;
    ++tried;
    put_measured(*patch);
    Body near;
    const Scalar chi2 = misfit(*patch, plane, &near);
    if (!(chi2 >= Scalar(0))) continue;
    if (counts)
      patch->wait.try_plane(map_.planes[k].id, map_.planes[k].known, static_cast<float>(chi2),
                            static_cast<float>(tuning::patch_keeper::kCornersGate));
    if (!(chi2 < tuning::patch_keeper::kCornersGate) || (nearest >= 0 && range >= least)) continue;
    nearest = k;
    least = range;
  }
  return nearest;
}

/// Whether the patch may lie on this plane as well, for all that its corners in this frame tell. Overwrites z_.
bool PatchKeeper::explains(const StoredPatch& patch, int entry) {
  Scalar range;
  const int plane = map_.planes[entry].slot;
  if (!may_lie_on(patch, entry, &range) ||
      !filter_.predict_patch(filter_.lens(), patch.block, plane, patch.reference_px, &z_))
    return false;
  put_measured(patch);
  Body near;
  const Scalar chi2 = misfit(patch, plane, &near);
  return !(chi2 >= tuning::patch_keeper::kCornersGate);
}

/// How far the corners are on average from where they would be if the camera had only rotated since its reference [px]; negative where
/// that cannot be told.
Scalar PatchKeeper::parallax_of(const StoredPatch& patch) const {
  const Quat q_CK = filter_.state().body.q_WC.conjugate() * ReferenceCamera::q_WC(filter_.state().block[patch.camera]);
  Scalar sum = 0;
  for (int k = 0; k < 4; ++k) {
    Vec3 ray_K;
    Vec2 rotated;
    if (!unproject(filter_.lens(), patch.reference_px[k], &ray_K) ||
        !project(filter_.lens(), Vec3(q_CK * ray_K), &rotated))
      return Scalar(-1);
    sum += (patch.corner[k] - rotated).norm();
  }
  return sum / 4;
}

bool PatchKeeper::has_parallax(const StoredPatch& patch, Scalar min_px) const { return parallax_of(patch) > min_px; }

/// As align(). Where nothing else supports the pose, that of a camera that has just begun to move is uncertain by more than the aligner
/// reaches: then the patch is looked for as far as from one frame to the next.
bool PatchKeeper::follow_waiting(const Pyramid& image, bool supported, Sight* sight, StoredPatch* patch,
                                 PlaneAlignment* found) {
  if (align(image, *sight, patch, found)) return true;
  Vec2 shift;
  return !supported &&
         search_.find(image, filter_.lens(), patch->pixels, sight->H_CK, FollowedView::covariance(filter_.lens()),
                      settings_.gate, &shift) &&
         move_to(*patch, shift, sight) && align(image, *sight, patch, found);
}

/// Follows a patch, and decides whether it is known by now which plane it lies on. Where nothing else supports the pose, the nearest plane
/// that passes counts at once, and nothing is held against the others.
void PatchKeeper::measure_waiting(const Pyramid& image, bool is_young, StoredPatch* patch) {
  Sight sight;
  patch->status = PatchStatus::kMissed;
  patch->weight = 0;
  if (!expect_waiting(*patch, &sight)) return;
  std::copy(sight.corner, sight.corner + 4, patch->corner);
  PlaneAlignment found;
  const bool supported = frame_.report.inliers >= settings_.min_inliers;
  if (!follow_waiting(image, supported, &sight, patch, &found) ||
      (!patch->is_proven() && !begin_block(patch, found.reference_covariance)))
    return;
  patch->status = PatchStatus::kWaiting;
  if (is_contested_) return;
  if (supported) patch->wait.begin_frame(!is_young || frame_.report.frames % kYoungEvery == 0);
  const int nearest = try_planes(patch, supported);
  if (!supported) {
    if (nearest >= 0) join(patch, nearest);
    return;
  }
  std::uint32_t id = 0;
  const bool parallax = has_parallax(*patch, kMinParallax);
  PlaneFit fit;
  Scalar range;
  if (!parallax || !fit_plane_to(*patch, &fit, &range, &patch->last_plane)) patch->last_plane.setZero();
  switch (patch->wait.decide(parallax, &id)) {
    case WaitVerdict::kWait:
      if (patch->wait.frames_without() > tuning::patch_keeper::kMaxRejections && parallax) refuse(patch);
      if (patch->wait.frames_without() == kFoundEvery) note_plane(patch);
      break;
    case WaitVerdict::kJoin:
      for (int k = 0; k < map_.planes.capacity(); ++k) {
        if (!map_.planes.used(k) || map_.planes[k].id != id) continue;
        if (is_seen_through(*patch, k)) refuse(patch);
        if (is_off_most(*patch, k) || is_before_another(*patch, k)) {
          refuse(patch);
          return give_up(patch);
        }
        return join(patch, k);
      }
      break;
    case WaitVerdict::kFound:
      found_or_wait(patch);
      break;
    case WaitVerdict::kGiveUp:
      give_up(patch);
  }
}

/// How far the wall is along the ray of the patch's middle, relative to the plane that two views of the patch tell: m, n / d in its
/// reference camera. False where they tell none.
bool PatchKeeper::wall_to_patch(const StoredPatch& patch, const Vec3& m, int entry, Scalar* ratio) const {
  Vec3 ray_K;
  Scalar range = 0;
  const Vec2 middle =
      (patch.reference_px[0] + patch.reference_px[1] + patch.reference_px[2] + patch.reference_px[3]) / 4;
  if (!unproject(filter_.lens(), middle, &ray_K) || !may_lie_on(patch, entry, &range)) return false;
  *ratio = range * m.dot(ray_K) / ray_K.norm();
  return *ratio > Scalar(0);
}

/// Whether another patch is farther, that waits and that the same wall explains, while nothing lies on the wall yet: the plan alone tells
/// then how far the wall is, and what stands before it passes the gate as well. Nothing stands behind it.
bool PatchKeeper::is_before_another(const StoredPatch& patch, int entry) const {
  Scalar own, other;
  if (!is_told_by_plan_alone(entry) || !wall_to_patch(patch, patch.last_plane, entry, &own)) return false;
  for (int i = 0; i < store_.capacity(); ++i) {
    const StoredPatch& another = store_[i];
    if (!store_.used(i) || another.id == patch.id || !another.wait.waits() || !another.was_found()) continue;
    if (another.wait.passes(map_.planes[entry].id) && wall_to_patch(another, another.last_plane, entry, &other) &&
        own > kFromMost * other)
      return true;
  }
  return false;
}

/// A wall that nothing lies on yet.
bool PatchKeeper::is_told_by_plan_alone(int entry) const {
  const PlaneEntry& wall = map_.planes[entry];
  return wall.known && wall.upheld == 0 && filter_.state().block[wall.slot].children == 0;
}

/// Whether the patch is nearer or farther than most points that are seen before a wall, which no point lies on yet. As long as the plan is
/// all that tells how far the wall is from these points, what stands before the wall passes the gate as well, and would move it there.
bool PatchKeeper::is_off_most(const StoredPatch& patch, int entry) const {
  const State& state = filter_.state();
  if (!is_told_by_plan_alone(entry)) return false;
  const CameraAt camera = camera_at(state, Scalar(0));
  Scalar ratio[kMaxMost], range = 0, of_patch = 0;
  int count = 0;
  for (int i = 0; i < map_.features.capacity() && count < kMaxMost; ++i) {
    if (!map_.features.used(i) || map_.features[i].last_seen_ns != frame_.report.t_ns) continue;
    const int slot = map_.features[i].slot;
    if (state.block[slot].kind == BlockKind::kPoint &&
        first_wall(filter_, map_, camera.p_W, filter_.point(slot) - camera.p_W, &range) == entry)
      ratio[count++] = range;
  }
  const CommonRatio most = find_common_ratio(ratio, count, kMostWidth);
  if (most.votes < kMinMost || 2 * most.votes < count) return false;
  PlaneFit fit;
  Vec3 m, ray_C, hit_W;
  const Vec2 middle = (patch.corner[0] + patch.corner[1] + patch.corner[2] + patch.corner[3]) / 4;
  if (!fit_plane_to(patch, &fit, &of_patch, &m) || !unproject(filter_.lens(), middle, &ray_C)) return false;
  const Vec3 ray_W = camera.q_WC * ray_C;
  if (!meets_wall(filter_, map_, entry, camera.p_W, ray_W, &range) ||
      !intersect_ray_plane(fit.frame, Vec3(Vec3::Zero()), camera.p_W, ray_W, &hit_W))
    return false;
  of_patch = range * ray_W.norm() / (hit_W - camera.p_W).norm();
  return of_patch > kFromMost * most.ratio || most.ratio > kFromMost * of_patch;
}

/// Whether a plane that explains the patch is behind the wall that was seen there when it began.
bool PatchKeeper::is_seen_through(const StoredPatch& patch, int entry) const {
  const int wall = patch.plane != 0 ? wall_of(patch) : -1;
  Scalar to_wall, to_plane;
  return wall >= 0 && wall != entry && may_lie_on(patch, wall, &to_wall) && may_lie_on(patch, entry, &to_plane) &&
         to_plane > to_wall;
}

/// From now on it is measured on this plane, and already in this frame.
void PatchKeeper::join(StoredPatch* patch, int entry) {
  const int plane = map_.planes[entry].slot;
  patch->wait.end();
  patch->plane = map_.planes[entry].id;
  if (!map_.planes[entry].known) extend_plane(*patch, entry);
  if (!filter_.predict_patch(filter_.lens(), patch->block, plane, patch->reference_px, &z_)) return;
  frame_.report.attempts += kWorth;
  frame_.report.matches += kWorth;
  put_measured(*patch);
  update(patch, entry);
}

/// It lies on nothing, and is dropped at the end of the frame.
void PatchKeeper::give_up(StoredPatch* patch) {
  patch->status = PatchStatus::kOutlier;
  patch->rejections = tuning::patch_keeper::kMaxRejections;
}

/// The wall that was seen there when it began does not explain it.
void PatchKeeper::refuse(StoredPatch* patch) {
  const int wall = patch->plane != 0 ? wall_of(*patch) : -1;
  if (wall >= 0) note_refused(*patch, wall);
  patch->plane = 0;
}

}  // namespace pf
