#include "filter_slam/patches/patch_keeper.h"

#include <algorithm>
#include <cmath>

#include "base/elapsed.h"
#include "filter_slam/patches/tuning.h"
#include "frame/tuning.h"
#include "geometry/small_cholesky.h"
#include "geometry/symmetric_eigen.h"

/// Patches that there are: found, measured, dropped. Where they are expected is in patch_sight.cpp, which plane they lie on in
/// patch_waiting.cpp, new ones in patch_selection.cpp.

namespace pf {
namespace {

using namespace tuning::patch_keeper;

/// Covariance of the mean of the four corners.
Mat2 middle_of(const Eigen::Matrix<Scalar, 8, 8>& C) {
  Mat2 sum = Mat2::Zero();
  for (int a = 0; a < 4; ++a)
    for (int b = 0; b < 4; ++b) sum += C.block<2, 2>(2 * a, 2 * b);
  return sum / (4 * 4);
}

}  // namespace

bool PatchKeeper::layout(Arena& arena) {
  store_.layout(arena, settings_.max_patches);
  search_.layout(arena);
  aligner_.layout(arena);
  return arena.ok();
}

void PatchKeeper::init() {
  store_.init();
  noise_.init(kCornerSigma);
  std::fill(in_vain_, in_vain_ + kMaxWalls, 0);
  std::fill(refusals_, refusals_ + kMaxRefusals, Refusal());
  in_vain_beside_ = next_refusal_ = 0;
  is_contested_ = false;
  generation_ = filter_.generation();
}

/// Where the filter began anew, the patches' blocks are gone.
void PatchKeeper::follow_filter() {
  if (generation_ == filter_.generation()) return;
  generation_ = filter_.generation();
  store_.clear();
}

/// The most proven patches first: what they say makes the others easier to find. Returns how many.
int PatchKeeper::list_in_order(int* order) const {
  int count = 0;
  for (int i = 0; i < store_.capacity(); ++i) {
    if (!store_.used(i)) continue;
    int at = count++;
    for (; at > 0 && store_[order[at - 1]].frames < store_[i].frames; --at) order[at] = order[at - 1];
    order[at] = i;
  }
  return count;
}

/// Entry of the plane that a patch lies on, which may have been merged; -1: it is gone or doubted.
int PatchKeeper::wall_of(const StoredPatch& patch) const {
  const std::uint32_t id = map_.planes.find(patch.plane);
  for (int k = 0; k < map_.planes.capacity() && id != 0; ++k)
    if (map_.planes.used(k) && map_.planes[k].id == id) return map_.planes[k].counts() ? k : -1;
  return -1;
}

void PatchKeeper::measure(const Pyramid& image, bool is_young) {
  StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kPatch]);
  follow_filter();
  int order[kMaxPatches];
  const int count = list_in_order(order);
  is_contested_ = false;
  std::fill(is_found_, is_found_ + kMaxPatches, false);
  if (frame_.report.inliers < settings_.min_inliers) put_agreeing_first(image, order, count);
  for (int k = 0; k < count; ++k) {
    StoredPatch* patch = &store_[order[k]];
    if (patch->wait.waits())
      measure_waiting(image, is_young, patch);
    else
      measure_patch(image, order[k]);
  }
  learn_noise();
}

/// R_gate of the corners of a patch that was found.
PatchKeeper::Mat8 PatchKeeper::noise_of(const StoredPatch& patch) const {
  return noise_.scale() * noise_.scale() * (patch.covariance + Mat8(Mat8::Identity() * (kCornerSigma * kCornerSigma)));
}

/// From what is left of inliers after the update: each corner has its own trace.
void PatchKeeper::learn_noise() {
  for (int i = 0; i < store_.capacity(); ++i) {
    if (!store_.used(i)) continue;
    const StoredPatch& patch = store_[i];
    if (patch.status != PatchStatus::kInlier || patch.frames < kSettledFrames) continue;
    const int wall = wall_of(patch);
    if (wall < 0 ||
        !filter_.predict_patch(filter_.lens(), patch.block, map_.planes[wall].slot, patch.reference_px, &z_))
      continue;
    const Mat8 R = noise_of(patch);
    const Scalar leverage = filter_.covariance_of<8>(z_.H).trace() / (noise_.correlation_frames() * R.trace());
    for (int k = 0; k < 4; ++k)
      noise_.learn(frame_.report.frames, patch.corner[k] - z_.predicted.segment<2>(2 * k), R.block<2, 2>(2 * k, 2 * k),
                   leverage, &residuals_[i][k]);
  }
  noise_.end_frame();
}

void PatchKeeper::measure_patch(const Pyramid& image, int i) {
  StoredPatch* patch = &store_[i];
  patch->status = PatchStatus::kUnseen;
  if (!is_found_[i]) patch->weight = 0;
  Sight sight;
  const int wall = wall_of(*patch);
  if (wall < 0 || !expect(*patch, wall, &sight)) return;
  if (!is_found_[i]) std::copy(sight.corner, sight.corner + 4, patch->corner);
  const int hiding = is_in_view(sight) ? hiding_wall(wall, sight) : -1;
  if (!is_in_view(sight) || !is_looked_for(hiding)) return;
  const int plane = map_.planes[wall].slot;
  if (hiding < 0) patch->status = PatchStatus::kMissed;
  frame_.report.attempts += hiding < 0 ? kWorth : 0;
  PlaneAlignment found;
  if (!filter_.predict_patch(filter_.lens(), patch->block, plane, patch->reference_px, &z_) ||
      (!is_found_[i] && (!find_from_afar(image, *patch, &sight) || !align(image, sight, patch, &found))))
    return;
  frame_.report.attempts += hiding < 0 ? 0 : kWorth;
  frame_.report.matches += kWorth;
  const bool is_through = hiding >= 0 && !explains(*patch, hiding);
  if (is_through && !filter_.predict_patch(filter_.lens(), patch->block, plane, patch->reference_px, &z_)) return;
  put_measured(*patch);
  update(patch, wall);
  if (hiding >= 0 && patch->status != PatchStatus::kInlier) patch->status = PatchStatus::kUnseen;
  count_through(patch, is_through && patch->status == PatchStatus::kInlier ? hiding : -1, sight.middle_W);
}

/// False where it is not found. Else the patch has its corners, their covariance and its light.
bool PatchKeeper::align(const Pyramid& image, const Sight& sight, StoredPatch* patch, PlaneAlignment* found) {
  PlaneStart start;
  start.H_CK = sight.H_CK;
  start.gain = patch->gain;
  start.offset = patch->offset;
  start.slack_px = kWarpSlack;
  *found = aligner_.align(image, filter_.lens(), patch->pixels, start, HomographyWarp());
  patch->weight = found->weight;
  if (!found->is_aligned()) return false;
  patch->gain = found->gain;
  patch->offset = found->offset;
  std::copy(found->corner, found->corner + 4, patch->corner);
  patch->covariance = found->covariance;
  return true;
}

/// Where the patch is expected within more pixels than the aligner reaches: looks for it. False where it is not there.
bool PatchKeeper::find_from_afar(const Pyramid& image, const StoredPatch& patch, Sight* sight) {
  const Mat2 innovation = middle_of(filter_.covariance_of<8>(z_.H));
  const Scalar widest = symmetric_eigenvalues(innovation)(1);
  if (!(widest > Scalar(0)) || settings_.gate * widest < kAlignerReach * kAlignerReach) return true;
  Vec2 shift;
  return search_.find(image, filter_.lens(), patch.pixels, sight->H_CK, innovation, settings_.gate, &shift) &&
         move_to(patch, shift, sight);
}

/// A patch that is found for the first time gets its rows: then it is known how well the reference's noise lets its corners be placed.
bool PatchKeeper::begin_block(StoredPatch* patch, const Mat8& covariance) {
  const int block = filter_.add_patch(patch->camera, covariance);
  if (block < 0) return false;
  filter_.unpin(patch->camera);
  patch->block = block;
  return true;
}

/// The corners that were found, and their noise, into the measurement.
void PatchKeeper::put_measured(const StoredPatch& patch) {
  for (int k = 0; k < 4; ++k) z_.measured.segment<2>(2 * k) = patch.corner[k];
  z_.R_gate = noise_of(patch);
  z_.R_update = noise_.correlation_frames() * z_.R_gate;
}

/// Chi-square of the corners, which are predicted on a plane (block): eight degrees of freedom, with the gate's noise. Negative where it
/// cannot be told.
Scalar PatchKeeper::misfit(const StoredPatch& patch, int plane, Body* near) {
  *near = filter_.state().body;
  const bool is_far = (z_.measured - z_.predicted).cwiseAbs().maxCoeff() > kLinearReach;
  if (is_far && !linearise_near(patch, plane, near)) return Scalar(-1);
  SmallCholesky<8> cholesky;
  if (!cholesky.factor(filter_.covariance_of<8>(z_.H) + z_.R_gate)) return Scalar(-1);
  const Vec8 r = z_.measured - z_.predicted;
  return r.dot(cholesky.solve<1>(r));
}

/// Takes the corners in where they pass the gate: all eight rows or none.
void PatchKeeper::update(StoredPatch* patch, int wall) {
  patch->status = PatchStatus::kOutlier;
  Body near;
  const Scalar chi2 = misfit(*patch, map_.planes[wall].slot, &near);
  if (!(chi2 >= Scalar(0) && chi2 < kCornersGate)) return;
  const Body& estimate = filter_.state().body;
  const bool is_far = near.p_W != estimate.p_W || near.q_WC.coeffs() != estimate.q_WC.coeffs();
  if (!is_far && !take_bent(*patch, map_.planes[wall].slot)) return;
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
  if (patch->frames == kUpheldFrames) ++map_.planes[wall].upheld;
}

int PatchKeeper::inlier_depths(Scalar* depth) const {
  const Body& body = filter_.state().body;
  const Vec3 forward = body.q_WC.toRotationMatrix().col(2);
  int count = 0;
  for (int i = 0; i < store_.capacity(); ++i) {
    Sight sight;
    if (!store_.used(i) || store_[i].status != PatchStatus::kInlier) continue;
    const int wall = wall_of(store_[i]);
    if (wall >= 0 && expect(store_[i], wall, &sight)) depth[count++] = forward.dot(sight.middle_W - body.p_W);
  }
  return count;
}

void PatchKeeper::maintain(const Pyramid& image, bool supported, bool may_begin) {
  StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kPatch]);
  follow_filter();
  drop_failing(supported);
  if (may_begin && !is_contested_) begin_patches(image);
  q_last_ = filter_.state().body.q_WC;
}

/// Its reference camera goes with the last patch that needs it.
void PatchKeeper::drop(int i) {
  const StoredPatch& patch = store_[i];
  if (patch.is_proven())
    filter_.remove(&patch.block, 1);
  else
    filter_.unpin(patch.camera);
  store_.remove(i);
}

/// A plane that was found lives as long as its patches, however few points it has.
void PatchKeeper::keep_plane(int entry) {
  SmallCount& weak = map_.planes[entry].weak;
  weak = std::min<int>(weak, tuning::plane_lifecycle::kMaxWeakFrames - 1);
}

void PatchKeeper::drop_failing(bool supported) {
  for (int i = 0; i < store_.capacity(); ++i) {
    if (!store_.used(i)) continue;
    StoredPatch& patch = store_[i];
    const int own = patch.is_proven() ? patch.block : patch.camera;
    const int wall = wall_of(patch);
    const bool waits = patch.wait.waits();
    bool fails = (wall < 0 && !waits) || !filter_.block_is_sound(own);
    if (wall >= 0 && !waits) keep_plane(wall);
    if (supported) {
      const bool inlier = patch.status == PatchStatus::kInlier || patch.status == PatchStatus::kWaiting;
      const auto count = [&](PatchStatus status, std::int16_t* in_a_row) {
        *in_a_row = static_cast<std::int16_t>(patch.status == status ? *in_a_row + 1 : inlier ? 0 : *in_a_row);
      };
      count(PatchStatus::kMissed, &patch.failures);
      count(PatchStatus::kOutlier, &patch.rejections);
      const bool refused = patch.rejections > kMaxRejections;
      if (refused && wall >= 0) note_refused(patch, wall);
      fails = fails || refused || patch.failures > (waits ? kMaxEarlyFailures : kMaxFailures);
    }
    if (fails) drop(i);
  }
}

}  // namespace pf
