#include "base/archive.h"
#include "base/table_entries.h"
#include "filter_slam/memory/filter_memory.h"

namespace pf {
namespace {

bool is_block(const Filter& filter, int slot, BlockKind kind) {
  return slot >= 0 && filter.state().block[slot].kind == kind && filter.state().block[slot].pins > 0;
}

}  // namespace

void PlaceMaker::carry(Archive& archive) {
  auto& [camera, generation, id, last_id, depth] = data_;
  archive.within(camera, -1, filter_.state().slots - 1);
  archive.any(generation, id, last_id);
  archive.numbers(depth);
  archive.require(!has_camera() || is_block(filter_, camera, BlockKind::kReferenceCamera));
}

/// Of a state that has begun again since, nothing is used.
void StatePlaces::carry(Archive& archive) {
  table_.carry(archive);
  archive.counts(entered_, settled_);
  archive.numbers(share_);
  archive.any(last_loaded_, generation_);
  for (int p = 0; p < table_.capacity(); ++p) {
    auto& [camera, anchor, entry, passed, brought, uses, is_on_trial] = link_[p];
    archive.within(camera, -1, filter_.state().slots - 1);
    archive.within(anchor, -1, filter_.state().slots - 1);
    archive.counts(entry, uses);
    archive.any(passed, brought);
    archive.flags(is_on_trial);
    if (camera >= 0 && generation_ == filter_.generation())
      archive.require(is_block(filter_, camera, BlockKind::kReferenceCamera) &&
                      is_block(filter_, anchor, BlockKind::kAnchor));
  }
}

void FilterMemory::carry(Archive& archive) {
  places_.carry(archive);
  maker_.carry(archive);
  recall_.carry(archive);
  rivals_.carry(archive);
  for (int k = 0; k < settings_.max_planes; ++k) {
    archive.any(record_[k].id);
    archive.numbers(record_[k].covariance);
  }
  archive.numbers(depth_);
  archive.flags(is_loaded_, is_found_, is_recalled_, recalled_in_vain_);
}

}  // namespace pf
