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

void FindShare::init() {
  mean_ = tuning::find_share::kPrior;
  weight_ = tuning::find_share::kWeight;
}

FindShare FindShare::of_another_view() {
  FindShare share;
  share.mean_ = Scalar(0.5);
  share.weight_ = 2;
  return share;
}

void FindShare::learn(int searched, int inliers) {
  using namespace tuning::find_share;
  if (searched == 0) return;
  const Scalar share = static_cast<Scalar>(inliers) / static_cast<Scalar>(searched);
  mean_ = std::clamp(mean_ + kGain * (share - mean_), kLeast, kGreatest);
}

Scalar FindShare::log_probability(int searched, int inliers) const {
  const Scalar a = weight_ * mean_, b = weight_ - a;
  return log_rising(a, inliers) + log_rising(b, searched - inliers) - log_rising(a + b, searched);
}

Scalar FindShare::in_frame(int searched, int inliers) const {
  return (weight_ * mean_ + static_cast<Scalar>(inliers)) / (weight_ + static_cast<Scalar>(searched));
}

Scalar evidence_against_chance(const PoseConsensus& consensus, const FindShare& share) {
  return share.log_probability(consensus.searched, consensus.inliers) + consensus.log_density - consensus.log_chance;
}

Scalar log_share_elsewhere(int searched, int inliers, Scalar alike) {
  using namespace tuning::elsewhere;
  const int others = searched - inliers;
  const Scalar any = log_rising(1, inliers) + log_rising(1, others) - log_rising(2, searched);
  const Scalar few = log_rising(1, inliers) + log_rising(kFew, others) - log_rising(1 + kFew, searched);
  return any + std::log(alike + kPart * std::exp(few - any));
}

Scalar pose_evidence(const PoseConsensus& consensus, const FindShare& share, const AlikeShare& alike) {
  const Scalar against_chance = evidence_against_chance(consensus, share);
  const Scalar against_alike = share.log_probability(consensus.searched, consensus.inliers) -
                               log_share_elsewhere(consensus.searched, consensus.inliers, std::exp(alike.log_share()));
  const Scalar least = std::min(against_chance, against_alike);
  return least - std::log1p(std::exp(least - std::max(against_chance, against_alike)));
}

}  // namespace pf
