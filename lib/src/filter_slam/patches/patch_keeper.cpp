#include "filter_slam/patches/patch_keeper.h"

#include <algorithm>

#include "base/elapsed.h"
#include "base/limits.h"
#include "base/table_entries.h"
#include "filter_slam/patches/patch_sight.h"
#include "filter_slam/patches/patch_walls.h"
#include "filter_slam/patches/tuning.h"
#include "frame/tuning.h"

namespace pf {
namespace {

using namespace tuning::patch_keeper;

/// A plane that was found lives as long as its patches, however few points it has.
void keep_plane(PlaneEntry* plane) {
  plane->weak = std::min<int>(plane->weak, tuning::plane_lifecycle::kMaxWeakFrames - 1);
}

}  // namespace

PatchKeeper::PatchKeeper(const Settings& settings, Filter& filter, Map& map, Frame& frame, FeatureKeeper& features,
                         TrackingState& tracking)
    : settings_(settings),
      filter_(filter),
      map_(map),
      frame_(frame),
      finder_(filter, settings.gate),
      update_(filter, map, frame, tracking, noise_, settings.research.gate_patches),
      consensus_(filter, map, store_, finder_, update_),
      refusals_(filter, map),
      founding_(settings, filter, map, frame, features, update_),
      membership_(settings, filter, map, frame, store_, finder_, update_, refusals_, founding_),
      initialiser_(settings, filter, map, frame, store_, features, noise_),
      selection_(settings, filter, map, frame, store_, refusals_, initialiser_) {}

bool PatchKeeper::layout(Arena& arena) {
  store_.layout(arena, settings_.max_patches);
  finder_.layout(arena);
  return arena.ok();
}

void PatchKeeper::init() {
  store_.init();
  noise_.init();
  refusals_.init();
  selection_.init();
  consensus_.begin_frame();
  generation_ = filter_.generation();
}

void PatchKeeper::follow_filter() {
  if (generation_ == filter_.generation()) return;
  generation_ = filter_.generation();
  store_.clear();
}

int PatchKeeper::list_in_order(int* order) const {
  int count = 0;
  for (const int i : used_entries(store_)) {
    int at = count++;
    for (; at > 0 && store_[order[at - 1]].frames < store_[i].frames; --at) order[at] = order[at - 1];
    order[at] = i;
  }
  return count;
}

void PatchKeeper::measure(const Pyramid& image, bool is_young) {
  StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kPatch]);
  follow_filter();
  int order[kMaxPatches];
  const int count = list_in_order(order);
  consensus_.begin_frame();
  if (frame_.report.inliers < settings_.min_inliers) consensus_.put_consistent_first(image, order, count);
  for (int k = 0; k < count; ++k) {
    StoredPatch* patch = &store_[order[k]];
    if (patch->wait.waits())
      membership_.measure(image, is_young, consensus_.is_contested(), patch);
    else
      measure_patch(image, order[k]);
  }
  learn_noise();
}

void PatchKeeper::learn_noise() {
  for (const int i : used_entries(store_)) {
    const StoredPatch& patch = store_[i];
    if (patch.status != PatchStatus::kInlier || patch.frames < kSettledFrames) continue;
    const int wall = wall_of(map_.planes, patch);
    if (wall < 0 || !update_.predict(patch, wall)) continue;
    const PatchMeasurement& z = update_.measurement();
    noise_.learn(frame_.report.frames, i, patch, z, filter_.covariance_of<8>(z.H).trace());
  }
  noise_.end_frame();
}

void PatchKeeper::measure_patch(const Pyramid& image, int i) {
  constexpr int kWorth = PatchUpdate::kWorth;
  StoredPatch* patch = &store_[i];
  const bool is_found = consensus_.has_found(i);
  patch->status = PatchStatus::kUnseen;
  if (!is_found) patch->weight = 0;
  PatchSight sight;
  const int wall = wall_of(map_.planes, *patch);
  if (wall < 0 || !expect_patch(filter_, map_.planes, *patch, wall, &sight)) return;
  if (!is_found) std::copy(sight.corner, sight.corner + 4, patch->corner);
  if (!is_in_view(filter_.lens(), sight)) return;
  const int hiding = hiding_wall(filter_, map_, wall, sight);
  if (hiding >= 0 && !is_known_by_plan_alone(filter_, map_.planes[hiding])) return;
  if (hiding < 0) patch->status = PatchStatus::kMissed;
  frame_.report.attempts += hiding < 0 ? kWorth : 0;
  bool is_through = false;
  if (!find(image, i, wall, hiding, &sight, &is_through)) return;
  update_.update(patch, wall);
  if (hiding >= 0 && patch->status != PatchStatus::kInlier) patch->status = PatchStatus::kUnseen;
  refusals_.count_through(patch, is_through && patch->status == PatchStatus::kInlier ? hiding : -1, sight.middle_W,
                          consensus_.is_contested());
}

bool PatchKeeper::find(const Pyramid& image, int i, int wall, int hiding, PatchSight* sight, bool* is_through) {
  constexpr int kWorth = PatchUpdate::kWorth;
  StoredPatch* patch = &store_[i];
  if (!update_.predict(*patch, wall)) return false;
  if (!consensus_.has_found(i) &&
      (!finder_.search(image, *patch, update_.measurement(), sight) || !finder_.align(image, *sight, patch)))
    return false;
  frame_.report.attempts += hiding < 0 ? 0 : kWorth;
  frame_.report.matches += kWorth;
  *is_through = hiding >= 0 && !update_.may_explain(*patch, hiding);
  if (*is_through) return update_.predict_measured(*patch, wall);
  update_.set_measured(*patch);
  return true;
}

int PatchKeeper::inlier_depths(Scalar* depth) const {
  const Body& body = filter_.state().body;
  const Vec3 forward = body.q_WC.toRotationMatrix().col(2);
  int count = 0;
  for (int i = 0; i < store_.capacity(); ++i) {
    PatchSight sight;
    if (!store_.used(i) || store_[i].status != PatchStatus::kInlier) continue;
    const int wall = wall_of(map_.planes, store_[i]);
    if (wall >= 0 && expect_patch(filter_, map_.planes, store_[i], wall, &sight))
      depth[count++] = forward.dot(sight.middle_W - body.p_W);
  }
  return count;
}

void PatchKeeper::maintain(const Pyramid& image, bool supported, bool may_begin) {
  StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kPatch]);
  follow_filter();
  drop_failing(supported);
  if (may_begin && !consensus_.is_contested()) selection_.begin_patches(image);
  membership_.end_frame();
}

bool PatchKeeper::count_failures(StoredPatch* patch, int wall) {
  const bool found = patch->status == PatchStatus::kInlier || patch->status == PatchStatus::kWaiting;
  const auto count = [&](PatchStatus status, std::int16_t* in_a_row) {
    *in_a_row = static_cast<std::int16_t>(patch->status == status ? *in_a_row + 1 : found ? 0 : *in_a_row);
  };
  count(PatchStatus::kMissed, &patch->failures);
  count(PatchStatus::kOutlier, &patch->rejections);
  const bool refused = patch->rejections > kMaxRejections;
  if (refused && wall >= 0) refusals_.note(*patch, wall);
  return refused || patch->failures > (patch->wait.waits() ? kMaxEarlyFailures : kMaxFailures);
}

void PatchKeeper::drop_failing(bool supported) {
  for (const int i : used_entries(store_)) {
    StoredPatch& patch = store_[i];
    const int own = patch.is_proven() ? patch.block : patch.camera;
    const int wall = wall_of(map_.planes, patch);
    const bool waits = patch.wait.waits();
    bool fails = (wall < 0 && !waits) || !filter_.block_is_sound(own);
    if (wall >= 0 && !waits) keep_plane(&map_.planes[wall]);
    if (supported && count_failures(&patch, wall)) fails = true;
    if (fails) drop_patch(filter_, store_, i);
  }
}

}  // namespace pf
