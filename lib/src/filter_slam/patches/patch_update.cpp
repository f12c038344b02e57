#include "filter_slam/patches/patch_update.h"

#include <algorithm>
#include <limits>

#include "filter_slam/patches/patch_linearisation.h"
#include "filter_slam/patches/patch_views.h"
#include "filter_slam/patches/patch_walls.h"
#include "filter_slam/patches/tuning.h"
#include "geometry/small_cholesky.h"

namespace pf {

using namespace tuning::patch_bend;
using tuning::patch_keeper::kLinearReach;
using tuning::patch_keeper::kUpheldFrames;

bool PatchUpdate::predict(const StoredPatch& patch, int entry) {
  return filter_.predict_patch(filter_.lens(), patch.block, map_.planes[entry].slot, patch.reference_px, &z_);
}

void PatchUpdate::set_measured(const StoredPatch& patch) {
  for (int k = 0; k < 4; ++k) z_.measured.segment<2>(2 * k) = patch.corner[k];
  noise_.set_noise(patch, &z_);
}

bool PatchUpdate::predict_measured(const StoredPatch& patch, int entry) {
  if (!predict(patch, entry)) return false;
  set_measured(patch);
  return true;
}

bool PatchUpdate::predict_measured_near(const StoredPatch& patch, int entry, const Body& near) {
  if (!predict_patch_near(filter_, patch, map_.planes[entry].slot, near, &z_)) return false;
  set_measured(patch);
  return true;
}

bool PatchUpdate::find_pose(const StoredPatch& patch, int entry, Body* near) {
  return predict_measured(patch, entry) && linearise_patch_near(filter_, patch, map_.planes[entry].slot, &z_, near);
}

Scalar PatchUpdate::chi_square(const Mat8& R) const {
  SmallCholesky<8> cholesky;
  if (!cholesky.factor(filter_.covariance_of<8>(z_.H) + R)) return Scalar(-1);
  const Vec8 r = z_.measured - z_.predicted;
  return r.dot(cholesky.solve<1>(r));
}

Scalar PatchUpdate::gate() const {
  return has_gate_ ? tuning::patch_keeper::kCornersGate : std::numeric_limits<Scalar>::max();
}

Scalar PatchUpdate::misfit(const StoredPatch& patch, int entry, Body* near) {
  *near = filter_.state().body;
  const bool is_far = (z_.measured - z_.predicted).cwiseAbs().maxCoeff() > kLinearReach;
  if (is_far && !linearise_patch_near(filter_, patch, map_.planes[entry].slot, &z_, near)) return Scalar(-1);
  return chi_square(z_.R_gate);
}

bool PatchUpdate::may_explain(const StoredPatch& patch, int entry) {
  Scalar range;
  Body near;
  return may_lie_on(filter_, map_, patch, entry, &range) && predict_measured(patch, entry) &&
         !(misfit(patch, entry, &near) >= gate());
}

void PatchUpdate::update(StoredPatch* patch, int entry) {
  patch->status = PatchStatus::kOutlier;
  Body near;
  const Scalar chi2 = misfit(*patch, entry, &near);
  if (!(chi2 >= Scalar(0) && chi2 < gate())) return;
  const Body& estimate = filter_.state().body;
  const bool is_far = near.p_W != estimate.p_W || near.q_WC.coeffs() != estimate.q_WC.coeffs();
  if (!is_far && !update_in_parts(*patch, entry)) return;
  Scalar nis = 0;
  const Measurement view = z_.view();
  if (!is_far) filter_.begin_update(&view, 1);
  const bool done =
      is_far ? filter_.finish_update_near(view, near, &nis) : filter_.finish_update(&view, 1, nullptr, &nis);
  tracking_.note_update(done);
  if (!done) return;
  patch->status = PatchStatus::kInlier;
  patch->last_seen_ns = frame_.report.t_ns;
  count_frame(&patch->frames);
  frame_.report.inliers += kWorth;
  frame_.report.nis += static_cast<double>(nis);
  frame_.report.nis_dof += z_.kHeight;
  if (patch->frames == kUpheldFrames) ++map_.planes[entry].upheld;
}

void PatchUpdate::join(StoredPatch* patch, int entry) {
  PlaneEntry& plane = map_.planes[entry];
  patch->wait.end();
  patch->plane = plane.id;
  if (!plane.known) extend_plane(filter_, *patch, &plane);
  if (!predict_measured(*patch, entry)) return;
  frame_.report.attempts += kWorth;
  frame_.report.matches += kWorth;
  update(patch, entry);
}

Scalar PatchUpdate::nonlinearity(const StoredPatch& patch) const {
  const Scalar parallax = std::max(parallax_of(filter_, patch), kMinParallax);
  const Scalar r2 = (z_.measured - z_.predicted).cwiseAbs2().maxCoeff();
  return r2 * r2 / (parallax * parallax);
}

bool PatchUpdate::update_in_parts(const StoredPatch& patch, int entry) {
  for (int round = 0; round < kMaxRounds; ++round) {
    if ((z_.measured - z_.predicted).cwiseAbs().maxCoeff() > kLinearReach) break;  // linearised elsewhere
    const Scalar bend = nonlinearity(patch);
    if (!(bend * z_.kHeight > kMinShare * z_.R_update.trace())) break;
    const Mat8 R = z_.R_update;
    z_.R_update += bend * Mat8::Identity();
    const Measurement part = z_.view();
    filter_.begin_update(&part, 1);
    const bool done = filter_.finish_update(&part, 1, nullptr, nullptr);
    tracking_.note_update(done);
    if (!done || !predict(patch, entry)) return false;
    z_.R_update = R + R.lazyProduct(R) / bend;
    const Scalar chi2 = chi_square(z_.R_update);
    if (!(chi2 >= Scalar(0) && chi2 < gate())) return false;
  }
  return true;
}

}  // namespace pf
