#include "filter_slam/patches/patch_refusals.h"

#include "filter_slam/patches/patch_sight.h"
#include "filter_slam/patches/patch_views.h"
#include "filter_slam/patches/patch_walls.h"
#include "filter_slam/patches/tuning.h"

namespace pf {

void PatchRefusals::init() {
  std::fill(refusals_, refusals_ + kMaxRefusals, Refusal());
  next_refusal_ = 0;
}

bool PatchRefusals::is_before(const StoredPatch& patch, int wall) const {
  PlaneFit fit;
  Vec3 m = Vec3::Zero();  // set however slanted the plane is
  Scalar range, ratio;
  fit_plane_to(filter_, patch, &fit, &range, &m);
  return parallax_of(filter_, patch) > tuning::patch_waiting::kMinParallax &&
         range_ratio(filter_, map_, patch, m, wall, &ratio) && ratio > Scalar(1);
}

bool PatchRefusals::is_told_already(std::uint32_t plane, int born) const {
  return std::any_of(refusals_, refusals_ + kMaxRefusals,
                     [&](const Refusal& other) { return other.plane == plane && other.born == born; });
}

void PatchRefusals::keep(const Refusal& refusal) {
  refusals_[next_refusal_] = refusal;
  next_refusal_ = (next_refusal_ + 1) % kMaxRefusals;
}

void PatchRefusals::note(const StoredPatch& patch, int wall) {
  if (!is_told_already(patch.plane, patch.born)) map_.planes[wall].refuse(is_before(patch, wall));
  PatchSight sight;
  if (expect_patch(filter_, map_.planes, patch, wall, &sight)) keep({patch.plane, patch.born, sight.middle_W});
}

void PatchRefusals::count_through(StoredPatch* patch, int hiding, const Vec3& middle_W, bool is_contested) {
  patch->through = static_cast<std::int16_t>(hiding >= 0 ? patch->through + 1 : 0);
  if (patch->through <= tuning::patch_keeper::kMaxRejections || is_contested) return;
  patch->through = 0;
  const std::uint32_t id = map_.planes[hiding].id;
  if (is_told_already(id, patch->born)) return;
  map_.planes[hiding].refuse(false);
  keep({id, patch->born, middle_W});
}

}  // namespace pf
