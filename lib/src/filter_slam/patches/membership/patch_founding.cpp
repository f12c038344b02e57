#include "filter_slam/patches/membership/patch_founding.h"

#include "filter_slam/patches/patch_views.h"
#include "filter_slam/patches/tuning.h"
#include "geometry/small_cholesky.h"

namespace pf {
namespace {

using namespace tuning::patch_founding;

constexpr int kRows = 3;  // of a plane

}  // namespace

void PatchFounding::note_plane(StoredPatch* patch) const {
  PlaneFit fit;
  Scalar range;
  fit_plane_to(filter_, *patch, &fit, &range, &patch->early_plane);
}

bool PatchFounding::would_tell(const StoredPatch& patch, int entry, const Mat3& prior) {
  using Vec8 = PatchMeasurement::Vector;
  SmallCholesky<8> cholesky;
  if (!update_.predict_measured(patch, entry)) return false;
  const PatchMeasurement& z = update_.measurement();
  if (!cholesky.factor(filter_.covariance_of<8>(z.H) + z.R_update)) return false;
  const int columns = z.H.columns(), at = z.H.part[0].size + z.H.part[1].size;
  for (int i = 0; i < prior.cols(); ++i) {
    Vec8 HP = Vec8::Zero();
    for (int a = 0; a < z.kHeight; ++a)
      for (int c = 0; c < prior.rows(); ++c) HP(a) += z.H.h[a * columns + at + c] * prior(c, i);
    if (!(prior(i, i) - HP.dot(cholesky.solve<1>(HP)) < kMinLearnt * kMinLearnt * prior(i, i))) return false;
  }
  return true;
}

bool PatchFounding::may_found(const StoredPatch& patch, PlaneFit* fit, Scalar* range) {
  Vec3 m;
  return settings_.planes && filter_.state().planes < filter_.state().max_planes &&
         fit_plane_to(filter_, patch, fit, range, &m) && (m - patch.early_plane).norm() < kMaxChange * m.norm() &&
         (filter_.room() >= kRows || features_.make_rows(kRows, frame_.report.t_ns));
}

bool PatchFounding::found_plane(StoredPatch* patch) {
  PlaneFit fit;
  Scalar range = 0;
  if (!may_found(*patch, &fit, &range)) return false;
  const Scalar sigma[kRows] = {kPriorSlope, kPriorSlope, kPriorRange * range};
  Mat3 prior = Mat3::Zero();
  for (int i = 0; i < kRows; ++i) prior(i, i) = sigma[i] * sigma[i];
  const int slot = filter_.add_known_plane(fit.frame, prior, settings_.fold.roughness);
  if (slot < 0) return false;
  const int entry = map_.planes.add(slot);
  filter_.set_owner(slot, entry);
  map_.planes[entry].roughness = settings_.fold.roughness;
  const bool told = would_tell(*patch, entry, prior);
  if (told) update_.join(patch, entry);
  if (told && patch->status == PatchStatus::kInlier && filter_.forget_prior(slot, prior, kWidening)) {
    settings_.hooks.say("plane ", map_.planes[entry].id, " found by patch ", patch->id, ", which no wall explains, ",
                        frame_.report.frames - patch->born, " frames after it began");
    return true;
  }
  filter_.remove(&slot, 1);
  map_.planes.remove(entry);
  return false;
}

bool PatchFounding::found_or_wait(StoredPatch* patch) {
  const int kEvery = tuning::patch_waiting::kFoundEvery;
  const int frames = patch->wait.frames_without(), phase = frames % kEvery;
  if (phase == 0) note_plane(patch);
  const bool is_time = phase == kEvery / 2 && parallax_of(filter_, *patch) > kFoundingParallax;
  return is_time ? found_plane(patch) : frames < kMaxFrames;
}

}  // namespace pf
