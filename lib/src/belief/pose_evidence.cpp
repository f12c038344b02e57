#include "belief/pose_evidence.h"

#include <algorithm>
#include <cmath>

#include "belief/tuning.h"

namespace pf {
namespace {

constexpr Scalar kLogTwoPi = Scalar(1.8378770664093453);

/// ln of a (a + 1) ... (a + n - 1)
Scalar log_rising(Scalar a, int n) {
  Scalar sum = 0;
  for (int i = 0; i < n; ++i) sum += std::log(a + static_cast<Scalar>(i));
  return sum;
}

}  // namespace

Scalar log_chance_density(Scalar searched_px2) {
  using namespace tuning::chance;
  return std::log(kMaxFindShare / std::max(searched_px2, kMinArea));
}

Scalar log_normal_density(Scalar nis, Scalar log_det, int n) {
  return -(nis + log_det) / 2 - static_cast<Scalar>(n) * kLogTwoPi;
}

void FindShare::init() { mean_ = tuning::find_share::kPrior; }

void FindShare::learn(int searched, int inliers) {
  using namespace tuning::find_share;
  if (searched == 0) return;
  const Scalar share = static_cast<Scalar>(inliers) / static_cast<Scalar>(searched);
  mean_ = std::clamp(mean_ + kGain * (share - mean_), kLeast, kGreatest);
}

Scalar FindShare::log_probability(int searched, int inliers) const {
  const Scalar a = tuning::find_share::kWeight * mean_, b = tuning::find_share::kWeight - a;
  return log_rising(a, inliers) + log_rising(b, searched - inliers) - log_rising(a + b, searched);
}

Scalar FindShare::in_frame(int searched, int inliers) const {
  using namespace tuning::find_share;
  return (kWeight * mean_ + static_cast<Scalar>(inliers)) / (kWeight + static_cast<Scalar>(searched));
}

Scalar evidence_against_chance(const PoseConsensus& consensus, const FindShare& share) {
  return share.log_probability(consensus.searched, consensus.inliers) + consensus.log_density - consensus.log_chance;
}

Scalar log_any_share(int searched, int inliers) {
  return log_rising(1, inliers) + log_rising(1, searched - inliers) - log_rising(2, searched);
}

Scalar pose_evidence(const PoseConsensus& consensus, const FindShare& share, const AlikeShare& alike) {
  const Scalar against_chance = evidence_against_chance(consensus, share);
  const Scalar against_alike = share.log_probability(consensus.searched, consensus.inliers) -
                               log_any_share(consensus.searched, consensus.inliers) - alike.log_share();
  const Scalar least = std::min(against_chance, against_alike);
  return least - std::log(1 + std::exp(least - std::max(against_chance, against_alike)));
}

}  // namespace pf
