#include "frame/noise_model.h"

#include <algorithm>
#include <cmath>

#include "frame/tuning.h"

namespace pf {
namespace {

using namespace tuning::noise;

}  // namespace

void NoiseModel::init(Scalar sigma_px, Scalar correlation_frames) {
  *this = NoiseModel();
  sigma_px_ = sigma_px;
  prior_tau_ = tau_ = correlation_frames;
  variance_ = sigma_px_ * sigma_px_;
}

Mat2 NoiseModel::match(const Mat2& fit, Scalar level_scale) const {
  const Scalar floor = sigma_px_ * level_scale;
  return scale_ * scale_ * (Mat2::Identity() * (floor * floor) + fit);
}

Scalar NoiseModel::sigma_gate() const { return std::sqrt(variance_); }
Scalar NoiseModel::sigma_info() const { return std::sqrt(variance_ * tau_); }

void NoiseModel::learn(int frame, const Vec2& residual, const Mat2& R_gate, Scalar leverage, ResidualTrace* trace) {
  const Scalar variance = (R_gate(0, 0) + R_gate(1, 1)) / 2;
  if (!(leverage < kMaxLeverage)) return;
  ++count_;
  const Scalar square = residual.squaredNorm() / (2 * variance * (1 - leverage));
  excess_ += std::min(square, kClip) / (1 - std::exp(-kClip)) - 1;
  frame_variance_ += variance;

  if (trace == nullptr) return;
  const Scalar sigma = std::sqrt(variance);
  Vec2 v;
  for (int a = 0; a < 2; ++a) v[a] = std::clamp(residual[a] / sigma, -kMaxResidual, kMaxResidual);
  if (trace->frame > 0) {
    const Scalar faded = std::pow(kMemory, static_cast<Scalar>(std::max(frame - trace->frame - 1, 0)));
    const Vec2 mean = faded * Vec2(static_cast<Scalar>(trace->mean[0]), static_cast<Scalar>(trace->mean[1]));
    squares_ += static_cast<double>(v.squaredNorm());
    products_ += static_cast<double>(v.dot(mean));
    pairs_ += 1;
    v = kMemory * mean + (1 - kMemory) * v;
  } else {
    v *= 1 - kMemory;
  }
  trace->mean[0] = static_cast<float>(v.x());
  trace->mean[1] = static_cast<float>(v.y());
  trace->frame = frame;
}

void NoiseModel::end_frame() {
  if (count_ == 0) return;
  const Scalar n = static_cast<Scalar>(count_), weight = kGain * std::min(n / kEnough, Scalar(1));
  scale_ = std::clamp(scale_ * std::exp(weight / 2 * excess_ / n), kMinScale, kMaxScale);
  variance_ += weight * (frame_variance_ / n - variance_);
  count_ = 0;
  excess_ = frame_variance_ = 0;
  if (squares_ > 0) {
    const double sum_rho = products_ / squares_ / (1 - static_cast<double>(kMemory));
    const double prior_pairs = static_cast<double>(kPriorPairs), seen = 1 + 2 * sum_rho;
    const double tau = (prior_pairs * static_cast<double>(prior_tau_) + pairs_ * seen) / (prior_pairs + pairs_);
    tau_ = std::clamp(static_cast<Scalar>(tau), kMinFrames, kMaxFrames);
  }
  squares_ *= static_cast<double>(kFade);
  products_ *= static_cast<double>(kFade);
  pairs_ *= static_cast<double>(kFade);
}

}  // namespace pf
