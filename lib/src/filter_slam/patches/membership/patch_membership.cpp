#include "filter_slam/patches/membership/patch_membership.h"

#include <algorithm>

#include "filter_slam/patches/patch_views.h"
#include "filter_slam/patches/patch_walls.h"
#include "filter_slam/patches/tuning.h"

namespace pf {
namespace {

using namespace tuning::patch_waiting;
using tuning::patch_keeper::kMaxRejections;

/// It lies on nothing, and is dropped at the end of the frame.
void give_up(StoredPatch* patch) {
  patch->status = PatchStatus::kOutlier;
  patch->rejections = kMaxRejections;
}

}  // namespace

bool PatchMembership::expect(const StoredPatch& patch, PatchSight* sight) const {
  const int likely = map_.planes.entry_of(patch.is_proven() ? patch.wait.likely() : patch.plane);
  if (likely >= 0 && map_.planes[likely].counts() && expect_patch(filter_, map_.planes, patch, likely, sight))
    return true;
  const Camera& lens = filter_.lens();
  const Quat q_now_last = filter_.state().body.q_WC.conjugate() * q_last_;
  Vec3 ray;
  for (int k = 0; k < 4; ++k)
    if (!unproject(lens, patch.corner[k], &ray) || !project(lens, Vec3(q_now_last * ray), &sight->corner[k]))
      return false;
  sight->cosine = 0;
  return fit_homography(lens, patch.pixels, sight);
}

bool PatchMembership::add_block(StoredPatch* patch, const PatchMeasurement::Matrix& covariance) {
  const int block = filter_.add_patch(patch->camera, covariance);
  if (block < 0) return false;
  filter_.unpin(patch->camera);
  patch->block = block;
  return true;
}

int PatchMembership::try_planes(StoredPatch* patch, bool counts) {
  int nearest = -1, tried = 0;
  Scalar least = 0;
  for (int k = 0; k < map_.planes.capacity() && tried < PatchWait::kMaxTrials; ++k) {
    Scalar range;
    if (!may_lie_on(filter_, map_, *patch, k, &range) || !update_.predict_measured(*patch, k)) continue;
    ++tried;
    Body near;
    const Scalar chi2 = update_.misfit(*patch, k, &near);
    if (!(chi2 >= Scalar(0))) continue;
    if (counts)
      patch->wait.try_plane(map_.planes[k].id, map_.planes[k].known, static_cast<float>(chi2),
                            static_cast<float>(update_.gate()));
    if (!(chi2 < update_.gate()) || (nearest >= 0 && range >= least)) continue;
    nearest = k;
    least = range;
  }
  return nearest;
}

bool PatchMembership::follow(const Pyramid& image, bool supported, StoredPatch* patch) {
  PatchSight sight;
  patch->status = PatchStatus::kMissed;
  patch->weight = 0;
  if (!expect(*patch, &sight)) return false;
  std::copy(sight.corner, sight.corner + 4, patch->corner);
  PatchMeasurement::Matrix reference_covariance;
  if (!finder_.follow(image, supported, &sight, patch, &reference_covariance) ||
      (!patch->is_proven() && !add_block(patch, reference_covariance)))
    return false;
  patch->status = PatchStatus::kWaiting;
  return true;
}

void PatchMembership::measure(const Pyramid& image, bool is_young, bool is_contested, StoredPatch* patch) {
  const bool supported = frame_.report.inliers >= settings_.min_inliers;
  if (!follow(image, supported, patch) || is_contested) return;
  if (supported) patch->wait.begin_frame(!is_young || frame_.report.frames % kYoungEvery == 0);
  const int nearest = try_planes(patch, supported);
  if (supported)
    decide(patch);
  else if (nearest >= 0)
    update_.join(patch, nearest);
}

void PatchMembership::decide(StoredPatch* patch) {
  const bool has_parallax = parallax_of(filter_, *patch) > kMinParallax;
  PlaneFit fit;
  Scalar range;
  if (!has_parallax || !fit_plane_to(filter_, *patch, &fit, &range, &patch->last_plane)) patch->last_plane.setZero();
  std::uint32_t id = 0;
  switch (patch->wait.decide(has_parallax, &id)) {
    case WaitVerdict::kWait:
      if (patch->wait.frames_without() > kMaxRejections && has_parallax) refuse(patch);
      if (patch->wait.frames_without() == kFoundEvery) founding_.note_plane(patch);
      break;
    case WaitVerdict::kJoin:
      join(patch, id);
      break;
    case WaitVerdict::kFound:
      if (!founding_.found_or_wait(patch)) give_up(patch);
      break;
    case WaitVerdict::kGiveUp:
      give_up(patch);
  }
}

void PatchMembership::join(StoredPatch* patch, std::uint32_t id) {
  const int entry = map_.planes.entry_of(id);
  if (entry < 0) return;
  if (is_seen_through(filter_, map_, *patch, entry)) refuse(patch);
  if (is_off_most_points(filter_, map_, frame_.report.t_ns, *patch, entry) ||
      is_before_another(filter_, map_, store_, *patch, entry)) {
    refuse(patch);
    give_up(patch);
  } else {
    update_.join(patch, entry);
  }
}

void PatchMembership::refuse(StoredPatch* patch) {
  const int wall = patch->plane != 0 ? wall_of(map_.planes, *patch) : -1;
  if (wall >= 0) refusals_.note(*patch, wall);
  patch->plane = 0;
}

}  // namespace pf
