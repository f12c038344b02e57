#include "track/patch_store.h"

namespace pf {

StoredPatch& PatchStore::begin(int i) {
  StoredPatch& p = entry_[i];
  p.id = next_id_++;
  p.plane = 0;
  p.camera = p.block = -1;
  p.frames = p.born = 0;
  p.failures = p.rejections = p.through = 0;
  p.status = PatchStatus::kNew;
  p.last_seen_ns = 0;
  p.gain = 1;
  p.offset = 0;
  p.weight = 0;
  for (int k = 0; k < 4; ++k) p.reference_px[k] = p.corner[k] = p.pixels.corner(k);
  p.covariance.setZero();
  p.wait.begin();
  p.early_plane.setZero();
  p.last_plane.setZero();
  return p;
}

int PatchStore::cameras() const {
  int n = 0;
  for (int i = 0; i < capacity_; ++i) {
    if (!used(i)) continue;
    bool first = true;
    for (int k = 0; k < i; ++k) first = first && !(used(k) && entry_[k].camera == entry_[i].camera);
    n += first;
  }
  return n;
}

}  // namespace pf
