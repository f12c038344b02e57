#include "base/archive.h"
#include "base/table_entries.h"
#include "filter_slam/filter_slam.h"

namespace pf {
namespace {

/// Each block that a table names is of that kind and names the entry, and each block of such a kind is named.
bool are_tables_of(const State& state, const Map& map) {
  int features = 0, planes = 0;
  for (const int i : used_entries(map.features)) {
    const Block& block = state.block[map.features[i].slot];
    if (info(block.kind).form == FeatureForm::kNone || block.owner != i) return false;
    ++features;
  }
  for (const int i : used_entries(map.planes)) {
    const Block& block = state.block[map.planes[i].slot];
    if (!is_plane(block.kind) || block.owner != i) return false;
    ++planes;
  }
  for (int s = 0; s < state.slots; ++s) {
    features -= info(state.block[s].kind).form != FeatureForm::kNone ? 1 : 0;
    planes -= is_plane(state.block[s].kind) ? 1 : 0;
  }
  return features == 0 && planes == 0;
}

bool is_camera(const State& state, int slot) {
  return slot < 0 || (state.block[slot].kind == BlockKind::kReferenceCamera && state.block[slot].pins > 0);
}

bool are_cameras(const State& state, const Map& map) {
  for (const int i : used_entries(map.anchors))
    if (!is_camera(state, map.anchors[i].camera)) return false;
  return is_camera(state, map.mark.camera);
}

}  // namespace

void Relocaliser::carry(Archive& archive) {
  views_.carry(archive);
  archive.numbers(depth_);
}

void ImageTracking::carry(Archive& archive) {
  noise_.carry(archive);
  warnings_.carry(archive);
  archive.flags(is_map_fixed_);
  front_end_.carry(archive);
  relocaliser_.carry(archive);
}

void MapUpkeep::carry(Archive& archive) {
  planes_.carry(archive);
  if (memory_ != nullptr) memory_->carry(archive);
  if (patches_ != nullptr) patches_->carry(archive);
}

void UnitKeeper::carry(Archive& archive) {
  rest_.carry(archive);
  watch_.carry(archive);
  metric_.carry(archive);
  archive.within(discredit_, 0, static_cast<int>(Discredit::kRejected));
  archive.flags(has_just_aligned_);
  if (parts_ == nullptr) return;
  parts_->hold.carry(archive);
  parts_->moving.carry(archive);
  parts_->forces.carry(archive);
}

/// A slot and a number that name no camera of the state are those of one that has left it.
void FollowedCamera::carry(Archive& archive) {
  auto& [slot, number, q_WK, p_WK] = data_;
  archive.within(slot, -1, filter_.state().slots - 1);
  archive.any(number);
  archive.numbers(q_WK, p_WK);
}

/// The map has been carried.
void FilterSlam::carry(Archive& archive) {
  auto& [frozen, filter_ns, since_last_ns, image_usable, follows, map_discredited, median_depth] = data_;
  frozen.carry(archive);
  archive.any(filter_ns, since_last_ns);
  archive.flags(image_usable, follows, map_discredited);
  archive.numbers(median_depth);
  filter_.carry(archive);
  if (archive.is_reading()) archive.require(are_tables_of(filter_.state(), map_) && are_cameras(filter_.state(), map_));
  frame_.carry(archive, map_.features);
  tracking_.carry(archive);
  motion_.carry(archive);
  update_.proposals().carry(archive);
  upkeep_.carry(archive);
  images_.carry(archive);
  start_.carry(archive);
  unit_.carry(archive);
  followed_.carry(archive);
}

}  // namespace pf
