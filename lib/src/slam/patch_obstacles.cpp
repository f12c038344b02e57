#include <algorithm>

#include "filter/camera_at.h"
#include "slam/patch_keeper.h"
#include "slam/patch_tuning.h"
#include "slam/tuning.h"

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

/// Keeps where a patch was that the gate refuses.
void PatchKeeper::note_refused(const StoredPatch& patch, int wall) {
  // Those that began in one frame share its camera: where that is wrong, all are.
  const bool is_same = std::any_of(refusals_, refusals_ + kMaxRefusals, [&](const Refusal& other) {
    return other.plane == patch.plane && other.born == patch.born;
  });
  if (!is_same) map_.planes[wall].refuse(is_before(patch, wall));
  Sight sight;
  if (!expect(patch, wall, &sight)) return;
  refusals_[next_refusal_] = {patch.plane, patch.born, sight.middle_W};
  next_refusal_ = (next_refusal_ + 1) % kMaxRefusals;
}

}  // namespace pf
