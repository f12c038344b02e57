#include "bundle/carry.h"

#include "bundle/start_bundle.h"
#include "geometry/carry.h"

namespace pf {

void StartRecord::carry(Archive& archive) {
  archive.any(begin_ns_);
  archive.within(frames_, 0, kMaxFrames);
  archive.within(features_, 0, kMaxFeatures);
  archive.within(held_, -1, kMaxFrames - 1);
  for (int i = 0; i < features_; ++i) archive.numbers(ray_[i]);
  for (int k = 0; k < frames_; ++k) {
    auto& [t_ns, q_WC, p_W] = frame_[k];
    archive.any(t_ns);
    archive.numbers(q_WC, p_W);
    for (int i = 0; i < kMaxFeatures; ++i) pf::carry(archive, pixel_[k * kMaxFeatures + i]);
  }
}

/// A depth is used where it is good. Before it is read, a lens that the config leaves open has been freed.
void StartBundle::carry(Archive& archive) {
  archive.numbers(last_parallax_);
  archive.any(random_);
  archive.flags(is_free_);
  for (int i = 0; i < StartRecord::kMaxFeatures; ++i) {
    archive.numbers(last_rho_[i]);
    if (good(i)) archive.numbers(rho_[i]);
  }
  archive.require(!is_free_ || lens_ != nullptr);
  if (!is_free_ || archive.failed()) return;
  pf::carry(archive, lens_->camera);  // all else of it is the config's (free_lens)
}

}  // namespace pf
