#include "frame/kept/carry.h"

#include "filter_slam/patches/patch_keeper.h"

namespace pf {

void PatchNoise::carry(Archive& archive) {
  model_.carry(archive);
  for (auto& of_patch : residuals_)
    for (ResidualTrace& trace : of_patch) pf::carry(archive, trace);
}

void PatchRefusals::carry(Archive& archive) {
  archive.within(next_refusal_, 0, kMaxRefusals - 1);
  for (Refusal& refusal : refusals_) {
    auto& [plane, born, middle_W] = refusal;
    archive.any(plane);
    archive.counts(born);
    if (plane != 0) archive.numbers(middle_W);
  }
}

void PatchSelection::carry(Archive& archive) {
  for (int& frames : in_vain_) archive.counts(frames);
  archive.counts(in_vain_beside_);
}

void PatchMembership::carry(Archive& archive) { archive.numbers(q_last_); }

/// Of a filter that has begun again since, no patch is used.
void PatchKeeper::carry(Archive& archive) {
  const State& state = filter_.state();
  archive.any(generation_);
  store_.carry(archive, state.slots, settings_.patch_side_px);
  noise_.carry(archive);
  refusals_.carry(archive);
  selection_.carry(archive);
  membership_.carry(archive);
  if (archive.is_reading() && generation_ != filter_.generation()) store_.clear();
  for (int i = 0; i < store_.capacity(); ++i) {
    if (!archive.is_reading() || !store_.used(i)) continue;
    const StoredPatch& patch = store_[i];
    archive.require(state.block[patch.camera].kind == BlockKind::kReferenceCamera &&
                    (patch.block < 0 || (state.block[patch.block].kind == BlockKind::kPatchCorners &&
                                         state.block[patch.block].parent == patch.camera)));
  }
}

}  // namespace pf
