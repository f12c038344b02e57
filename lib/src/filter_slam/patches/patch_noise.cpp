#include "filter_slam/patches/patch_noise.h"

#include "filter_slam/patches/tuning.h"

namespace pf {

using tuning::patch_keeper::kCornerSigma;

void PatchNoise::init() { model_.init(kCornerSigma); }

void PatchNoise::forget(int entry) {
  for (ResidualTrace& trace : residuals_[entry]) trace = ResidualTrace();
}

PatchMeasurement::Matrix PatchNoise::gate_noise(const StoredPatch& patch) const {
  using Mat8 = PatchMeasurement::Matrix;
  return model_.scale() * model_.scale() * (patch.covariance + Mat8(Mat8::Identity() * (kCornerSigma * kCornerSigma)));
}

void PatchNoise::set_noise(const StoredPatch& patch, PatchMeasurement* z) const {
  z->R_gate = gate_noise(patch);
  z->R_update = model_.correlation_frames() * z->R_gate;
}

void PatchNoise::learn(int frame, int entry, const StoredPatch& patch, const PatchMeasurement& z, Scalar trace_HPH) {
  const PatchMeasurement::Matrix R = gate_noise(patch);
  const Scalar leverage = trace_HPH / (model_.correlation_frames() * R.trace());
  for (int k = 0; k < 4; ++k)
    model_.learn(frame, patch.corner[k] - z.predicted.segment<2>(2 * k), R.block<2, 2>(2 * k, 2 * k), leverage,
                 &residuals_[entry][k]);
}

}  // namespace pf
