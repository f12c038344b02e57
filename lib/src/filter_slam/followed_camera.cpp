#include "filter_slam/followed_camera.h"

#include "model/reference_camera.h"

namespace pf {

using model::ReferenceCamera;

namespace {

/// Not one that came from a record.
bool is_copy(const Block& block) { return block.kind == BlockKind::kReferenceCamera && block.owner >= 0; }

}  // namespace

Similarity FollowedCamera::moved() const {
  if (data_.slot < 0) return Similarity();
  const Block& block = filter_.state().block[data_.slot];
  const bool is_there = is_copy(block) && block.owner == data_.number;
  if (!is_there || !filter_.block_is_sound(data_.slot)) return Similarity();
  return Similarity::between(data_.q_WK, data_.p_WK, ReferenceCamera::q_WC(block).normalized(),
                             ReferenceCamera::p_WC(block));
}

void FollowedCamera::follow_newest() {
  data_ = Data();
  const State& state = filter_.state();
  for (int s = 0; s < state.slots; ++s) {  // rows keep the order in which they came
    const bool is_newest = data_.slot < 0 || filter_.first_row(s) > filter_.first_row(data_.slot);
    if (is_copy(state.block[s]) && is_newest) data_.slot = s;
  }
  if (data_.slot < 0) return;
  const Block& block = state.block[data_.slot];
  data_.number = block.owner;
  data_.q_WK = ReferenceCamera::q_WC(block).normalized();
  data_.p_WK = ReferenceCamera::p_WC(block);
}

}  // namespace pf
