#pragma once

#include "base/limits.h"
#include "filter/filter.h"
#include "frame/noise_model.h"
#include "track/patch_store.h"

namespace pf {

class Archive;

/// Noise of the corners of patches, estimated from the residuals of all patches together. Each corner has its own trace of residuals.
class PatchNoise {
 public:
  void init();
  /// Clears the residuals of an entry of the store that gets another patch.
  void forget(int entry);

  /// Sets R_gate and R_update of the corners of a patch that was found.
  void set_noise(const StoredPatch& patch, PatchMeasurement* z) const;

  /// Adds an inlier's residuals after the update. z: its corners as predicted then. trace_HPH: of their covariance [px^2].
  void learn(int frame, int entry, const StoredPatch& patch, const PatchMeasurement& z, Scalar trace_HPH);
  /// Updates the noise with the residuals that learn() has gathered in this frame.
  void end_frame() { model_.end_frame(); }

  void carry(Archive& archive);  ///< base/archive.h

 private:
  PatchMeasurement::Matrix gate_noise(const StoredPatch& patch) const;

  NoiseModel model_;
  ResidualTrace residuals_[kMaxPatches][4];  ///< of each entry's corners
};

}  // namespace pf
