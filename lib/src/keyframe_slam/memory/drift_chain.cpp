#include "keyframe_slam/memory/drift_chain.h"

#include "base/archive.h"

namespace pf {

void DriftChain::add(const MapDrift& drift, const Vec3& p_W) {
  if (!drift.any) return;
  SimilarityCovariance Q = SimilarityCovariance::Zero();
  Q.topLeftCorner<6, 6>() = drift.Q.cast<double>();
  Q(6, 6) = static_cast<double>(drift.sigma_scale) * static_cast<double>(drift.sigma_scale);
  data_.sum += similarity_covariance_at(-p_W, Q);
}

SimilarityCovariance DriftChain::between(int number, const SimilarityCovariance& older,
                                         const SimilarityCovariance& younger) const {
  const bool hangs_between = data_.hung_on > 0 && number > data_.hung_on && number <= data_.closed_at;
  return hangs_between ? SimilarityCovariance(older - data_.hung + younger - data_.hung)
                       : SimilarityCovariance(younger - older);
}

void DriftChain::carry(Archive& archive) {
  auto& [sum, hung, hung_on, closed_at] = data_;
  archive.numbers(sum, hung);
  archive.within(hung_on, 0, INT32_MAX);
  archive.within(closed_at, 0, INT32_MAX);
}

}  // namespace pf
