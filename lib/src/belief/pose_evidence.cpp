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

/// ln of the probability that just k of n are found where the chance has the prior Beta(kWeight mean, kWeight (1 - mean)).
Scalar log_share_about(Scalar mean, int n, int k) {
  const Scalar a = tuning::find_share::kWeight * mean, b = tuning::find_share::kWeight - a;
  return log_rising(a, k) + log_rising(b, n - k) - log_rising(a + b, n);
}

}  // namespace

Scalar log_chance_density(Scalar searched_px2) {
  using namespace tuning::chance;
  return std::log(kMaxFindShare / std::max(searched_px2, kMinArea));
}

Scalar log_normal_density(Scalar nis, Scalar log_det, int n) {
  return -(nis + log_det) / 2 - static_cast<Scalar>(n) * kLogTwoPi;
}

void FindShare::init() {
  mean_ = tuning::find_share::kPrior;
  as_sharp_ = 1;
}

void FindShare::learn(int searched, int inliers) {
  using namespace tuning::find_share;
  if (searched == 0) return;
  const Scalar share = static_cast<Scalar>(inliers) / static_cast<Scalar>(searched);
  mean_ = std::clamp(mean_ + kGain * (share - mean_), kLeast, kGreatest);
}

Scalar FindShare::log_usual(int searched, int inliers) const { return log_share_about(mean_, searched, inliers); }

Scalar FindShare::log_paired(int inliers, int paired) const { return log_share_about(mean_, inliers, paired); }

Scalar FindShare::log_probability(int searched, int inliers) const {
  const Scalar usual = log_usual(searched, inliers);
  if (as_sharp_ >= Scalar(1)) return usual;
  const Scalar any = log_any_share(searched, inliers);
  return any + std::log(1 - as_sharp_ + as_sharp_ * std::exp(usual - any));
}

bool FindShare::is_unlikely(int searched, int inliers) const {
  return is_less(searched, inliers) && log_usual(searched, inliers) < log_any_share(searched, inliers);
}

Scalar FindShare::in_frame(int searched, int inliers) const {
  using namespace tuning::find_share;
  return (kWeight * mean_ + static_cast<Scalar>(inliers)) / (kWeight + static_cast<Scalar>(searched));
}

namespace {

/// ln P(k of n found) where the pose is right.
Scalar log_found(const PoseConsensus& consensus, const FindShare& share) {
  return consensus.is_elsewhere ? log_any_share(consensus.searched, consensus.inliers)
                                : share.log_probability(consensus.searched, consensus.inliers);
}

/// ln r of log_share_elsewhere().
Scalar log_neighbours(const PoseConsensus& consensus, const FindShare& share) {
  const int found = consensus.inliers;
  if (consensus.paired < 0 || consensus.searched < 2) return 0;
  const Scalar n = static_cast<Scalar>(consensus.searched);
  const Scalar scattered = std::clamp(static_cast<Scalar>(found - 1) / (n - 1), 1 / n, 1 - 1 / n);
  return share.log_paired(found, consensus.paired) - log_share_about(scattered, found, consensus.paired);
}

}  // namespace

Scalar evidence_against_chance(const PoseConsensus& consensus, const FindShare& share) {
  return log_found(consensus, share) + consensus.log_density - consensus.log_chance;
}

Scalar log_any_share(int searched, int inliers) {
  return log_rising(1, inliers) + log_rising(1, searched - inliers) - log_rising(2, searched);
}

Scalar log_share_elsewhere(const PoseConsensus& consensus, const FindShare& share, const AlikeShare& alike) {
  using namespace tuning::common_part;
  const int found = consensus.inliers, missed = consensus.searched - found;
  const Scalar any = log_any_share(consensus.searched, found);
  const Scalar b = 1 / (kPart * share.mean()) - 1;
  const Scalar few = log_neighbours(consensus, share) + log_rising(1, found) + log_rising(b, missed) -
                     log_rising(1 + b, consensus.searched);
  return any + std::log(std::exp(alike.log_share()) + kShare * std::exp(few - any));
}

Scalar pose_evidence(const PoseConsensus& consensus, const FindShare& share, const AlikeShare& alike) {
  const Scalar against_chance = evidence_against_chance(consensus, share);
  const Scalar against_alike = log_found(consensus, share) - log_share_elsewhere(consensus, share, alike);
  const Scalar least = std::min(against_chance, against_alike);
  return least - std::log(1 + std::exp(least - std::max(against_chance, against_alike)));
}

}  // namespace pf
