#include <algorithm>
#include <cmath>

#include "filter/filter.h"
#include "filter/tuning.h"

/// What is kept apart from P, and moves between both (lib/docs/theory/gauge.md).

namespace pf {

using namespace tuning::apart;

/// Whether nothing measures the place or the scale of W, as an inertial unit would, so that their uncertainty may be kept apart.
bool Filter::keeps_apart() const {
  return keep_gauge_ && told_updates_ == 0 && state_.unobservable == gauge::kBareCamera &&
         !state_.layout.has(BodyPart::kGravity);
}

void Filter::set_body(const Body& body, const Scalar* covariance, const Scalar* J_lens) {
  const int rows = state_.layout.unit_rows();
  state_.body = body;
  apart_.clear();
  if (body.v_W != Vec3::Zero() && told_updates_ == 0) told_updates_ = kSpeedTells;
  Scalar largest = 0;
  for (int i = 0; i < Body::kPoseDim; ++i) largest = std::max(largest, covariance[i * rows + i]);
  if (!keeps_apart() || J_lens != nullptr || largest < kMinPoseSigma * kMinPoseSigma) {
    blocks_.set_leading(covariance, rows, J_lens);
    return;
  }
  apart_.set_pose(state_, covariance, rows);
  Scalar left[BodyLayout::kMaxUnitRows * BodyLayout::kMaxUnitRows];
  std::copy(covariance, covariance + rows * rows, left);
  for (int i = 0; i < Body::kPoseDim; ++i)
    for (int j = 0; j < Body::kPoseDim; ++j) left[i * rows + j] = i == j ? kLeftSigma * kLeftSigma : Scalar(0);
  blocks_.set_leading(left, rows, nullptr);
}

void Filter::body_covariance(int rows, Scalar* out) const {
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < rows; ++j) out[i * rows + j] = covariance()(i, j);
  if (apart_.any()) apart_.add_leading(state_, rows, out);
}

void Filter::tell_gauge() {
  told_updates_ = -1;
  if (!apart_.any()) return;
  transport_.spread(state_, blocks_, apart_.V());
  blocks_.add_shared(transport_.U(), transport_.G(), transport_.rows());
  apart_.clear();
}

/// After an update: the scale leaves P where the variance of l, the best known log length, is too large.
void Filter::end_update_apart(const ScaleRow& l) {
  if (l.parts > 0 && blocks_.variance(l) > kMaxScaleVariance) apart_.add_scale(replace_scale(kLeftScaleVariance));
}

/// The log scale of all that has one, weighted by how well each is known:  l = sum l_k / v_k / sum 1 / v_k,  v_k = l_k P l_k^T.
///
///   P <- (I - N_s l) P (I - N_s l)^T + left N_s N_s^T
///
/// Returns the former l P l^T; 0, with nothing changed, where there is no log length. Rows with J N_s = 0, which do not see the scale, keep
/// their J P J^T. Their covariance with l is dropped; it is zero where P has nothing of the scale but independent priors of depths.
Scalar Filter::replace_scale(Scalar left) {
  int places = -1;
  Scalar total = 0;
  ScaleRow row;
  for (int s = 0; s < state_.slots; ++s) {
    if (!scale_candidate(s, &places, &row)) continue;
    const Scalar variance = blocks_.variance(row);
    if (variance > Scalar(0)) total += Scalar(1) / variance;
  }
  if (!(total > Scalar(0))) return Scalar(0);
  const auto weighted = [&](int slot, ScaleRow* l) {
    if (!scale_candidate(slot, &places, l)) return false;
    const Scalar variance = blocks_.variance(*l);
    if (!(variance > Scalar(0))) return false;
    for (int i = 0; i < l->columns(); ++i) l->h[i] /= variance * total;
    return true;
  };
  return blocks_.take_out(transport_.scale_direction(state_, blocks_), left, state_.slots, weighted);
}

}  // namespace pf
