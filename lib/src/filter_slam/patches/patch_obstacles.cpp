#include <algorithm>

#include "filter_slam/patches/patch_keeper.h"
#include "filter_slam/patches/tuning.h"
#include "model/camera_at.h"

/// What stands before a wall: no patch begins where it is seen.

namespace pf {

using namespace tuning::patch_selection;

/// Pixels of this frame's features that the gate refuses on the wall, and of places where patches of it were found elsewhere.
void PatchKeeper::list_obstacles(int wall, Obstacles* obstacles) const {
  const PlaneEntry& plane = map_.planes[wall];
  const Scalar noise = plane.roughness * plane.roughness;
  obstacles->count = 0;
  const auto add = [&](const Vec2& pixel) {
    if (obstacles->count < Obstacles::kMax) obstacles->pixel[obstacles->count++] = pixel;
  };
  const CameraAt camera = camera_at(filter_.state(), Scalar(0));
  for (const Refusal& refusal : refusals_) {
    Vec2 pixel;
    if (refusal.plane == plane.id &&
        project(filter_.lens(), Vec3(camera.q_WC.conjugate() * (refusal.middle_W - camera.p_W)), &pixel))
      add(pixel);
  }
  for (int t = 0; t < frame_.match_count(); ++t) {
    const Match& match = frame_.match(t);
    Scalar d, variance;
    if (match.feature < 0 || match.status != MatchStatus::kInlier) continue;
    if (filter_.distance(plane.slot, map_.features[match.feature].slot, &d, &variance) &&
        d * d > kObstacleGate * (variance + noise))
      add(match.measured);
  }
}

bool PatchKeeper::Obstacles::are_in(const Square& square) const {
  const Scalar half = static_cast<Scalar>(square.side - 1) / 2, reach = half * (Scalar(1) + kMargin);
  const Vec2 middle(static_cast<Scalar>(square.left) + half, static_cast<Scalar>(square.top) + half);
  for (int k = 0; k < count; ++k)
    if ((pixel[k] - middle).cwiseAbs().maxCoeff() < reach) return true;
  return false;
}

/// Whether two views of the patch tell that it is before the wall.
bool PatchKeeper::is_before(const StoredPatch& patch, int wall) const {
  PlaneFit fit;
  Vec3 m = Vec3::Zero();  // set however slanted the plane is
  Scalar range, ratio;
  fit_plane_to(patch, &fit, &range, &m);
  return has_parallax(patch, tuning::patch_waiting::kMinParallax) && wall_to_patch(patch, m, wall, &ratio) &&
         ratio > Scalar(1);
}

/// Whether a patch that began in the same frame has refused the plane: they share its camera, and where that is wrong, all are.
bool PatchKeeper::is_told_already(std::uint32_t plane, int born) const {
  return std::any_of(refusals_, refusals_ + kMaxRefusals,
                     [&](const Refusal& other) { return other.plane == plane && other.born == born; });
}

/// Keeps where a patch was that the gate refuses.
void PatchKeeper::note_refused(const StoredPatch& patch, int wall) {
  if (!is_told_already(patch.plane, patch.born)) map_.planes[wall].refuse(is_before(patch, wall));
  Sight sight;
  if (expect(patch, wall, &sight)) keep_refusal({patch.plane, patch.born, sight.middle_W});
}

/// In place of the oldest.
void PatchKeeper::keep_refusal(const Refusal& refusal) {
  refusals_[next_refusal_] = refusal;
  next_refusal_ = (next_refusal_ + 1) % kMaxRefusals;
}

/// A patch that is measured on another plane, though the plan has a wall before it (-1: none). Five frames in a row refuse this wall: it is
/// seen through.
void PatchKeeper::count_through(StoredPatch* patch, int hiding, const Vec3& middle_W) {
  patch->through = static_cast<std::int16_t>(hiding >= 0 ? patch->through + 1 : 0);
  if (patch->through <= tuning::patch_keeper::kMaxRejections || is_contested_) return;
  patch->through = 0;
  const std::uint32_t id = map_.planes[hiding].id;
  if (is_told_already(id, patch->born)) return;
  map_.planes[hiding].refuse(false);
  keep_refusal({id, patch->born, middle_W});
}

}  // namespace pf
