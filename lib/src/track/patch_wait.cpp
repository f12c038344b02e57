#include "track/patch_wait.h"

#include "track/tuning.h"

namespace pf {
namespace {

using namespace tuning::patch_wait;

void count(std::uint8_t* n) {
  if (*n < 255) ++*n;
}

}  // namespace

bool PatchWait::Trial::is_open() const { return over < kPersist; }

void PatchWait::begin_frame(bool counts) {
  if (counts) count(&frames_);
  for (int i = 0; i < count_; ++i) trial_[i].tried = false;
}

void PatchWait::try_plane(std::uint32_t plane, bool known, float chi2, float gate) {
  int i = 0;
  while (i < count_ && trial_[i].plane != plane) ++i;
  if (i == kMaxTrials) return;
  if (i == count_) {
    trial_[count_++] = Trial();
    trial_[i].plane = plane;
    trial_[i].known = known;
  }
  Trial& trial = trial_[i];
  trial.tried = true;
  trial.chi2 = chi2;
  if (chi2 < gate) {
    trial.over = 0;
    count(&trial.under);
  } else {
    trial.under = 0;
    count(&trial.over);
  }
}

int PatchWait::open() const {
  int n = 0;
  for (int i = 0; i < count_; ++i) n += trial_[i].is_open();
  return n;
}

bool PatchWait::passes(std::uint32_t plane) const {
  for (int i = 0; i < count_; ++i)
    if (trial_[i].plane == plane) return trial_[i].over == 0;
  return false;
}

std::uint32_t PatchWait::likely() const {
  const Trial* best = nullptr;
  for (int i = 0; i < count_; ++i)
    if (trial_[i].over == 0 && (best == nullptr || trial_[i].chi2 < best->chi2)) best = &trial_[i];
  return best == nullptr ? 0 : best->plane;
}

/// Null where there is none, or more than one.
const PatchWait::Trial* PatchWait::only_open(bool walls_alone) const {
  const Trial* only = nullptr;
  for (int i = 0; i < count_; ++i) {
    if (!trial_[i].is_open() || (walls_alone && !trial_[i].known)) continue;
    if (only != nullptr) return nullptr;
    only = &trial_[i];
  }
  return only;
}

WaitVerdict PatchWait::decide(bool has_parallax, std::uint32_t* joined) {
  // Planes that are gone, or whose outline does not hold it any more.
  int kept = 0, passing = 0;
  for (int i = 0; i < count_; ++i)
    if (trial_[i].tried) trial_[kept++] = trial_[i];
  count_ = static_cast<std::uint8_t>(kept);
  for (int i = 0; i < count_; ++i) {
    passing += trial_[i].over == 0;
    if (!has_parallax) trial_[i].under = 0;
  }
  if (passing > 0)
    without_ = 0;
  else
    count(&without_);
  const bool has_waited = frames_ >= kMaxFrames;
  // A found plane may lie in the wall itself, and no parallax distinguishes them then.
  const Trial* only = only_open(false);
  if (only == nullptr && has_waited) only = only_open(true);
  if (only != nullptr && only->over == 0 && (only->under >= kPersist || has_waited)) {
    *joined = only->plane;
    return WaitVerdict::kJoin;
  }
  if (without_ < kMaxFrames) return WaitVerdict::kWait;
  return has_parallax ? WaitVerdict::kFound : WaitVerdict::kGiveUp;
}

}  // namespace pf
