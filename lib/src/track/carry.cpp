#include "vision/carry.h"

#include "track/patch_store.h"
#include "track/view_memory.h"

namespace pf {

void PatchWait::carry(Archive& archive) {
  archive.within(count_, 0, kMaxTrials);
  archive.any(frames_, without_);
  archive.flags(waits_);
  for (int i = 0; i < count_; ++i) {
    auto& [plane, chi2, under, over, known, tried] = trial_[i];
    archive.any(plane, under, over);
    archive.numbers(chi2);
    archive.flags(known, tried);
  }
}

void PatchStore::carry(Archive& archive, int slots, int max_side) {
  archive.any(next_id_);
  for (int i = 0; i < capacity_; ++i) {
    auto& [id, plane, camera, block, frames, born, failures, rejections, through, status, last_seen_ns, gain, offset,
           weight, reference_px, corner, covariance, wait, early_plane, last_plane, pixels] = entry_[i];
    archive.any(id);
    if (id == 0) continue;
    archive.any(plane, last_seen_ns);
    archive.within(camera, 0, slots - 1);
    archive.within(block, -1, slots - 1);
    archive.counts(frames, born);
    for (std::int16_t* count : {&failures, &rejections, &through}) archive.within(*count, 0, INT16_MAX);
    archive.within(status, 0, static_cast<int>(PatchStatus::kWaiting));
    archive.numbers(gain, offset, weight, reference_px, corner, early_plane, last_plane);
    if (status != PatchStatus::kUnseen) archive.numbers(covariance);
    wait.carry(archive);
    pf::carry(archive, pixels, max_side);
  }
}

void ViewMemory::carry(Archive& archive) {
  archive.within(count_, 0, capacity_);
  archive.within(next_, 0, capacity_ > 0 ? capacity_ - 1 : 0);
  for (int i = 0; i < count_; ++i) {
    auto& [thumbnail, q_WC, p_W] = view_[i];
    archive.bytes(thumbnail.pixels, sizeof thumbnail.pixels);
    archive.numbers(q_WC, p_W);
  }
}

}  // namespace pf
