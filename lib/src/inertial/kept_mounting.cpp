#include "inertial/kept_mounting.h"

namespace pf {

bool KeptMounting::layout(Arena& arena) {
  if (layout_.estimates_unit()) kept_ = arena.take<Kept>(1);
  return arena.ok();
}

void KeptMounting::init() {
  if (kept_ == nullptr) return;
  const int first = first_row(), rows = num_rows();
  kept_->mounting = unit_.mounting;
  for (Scalar& c : kept_->covariance) c = Scalar(0);
  const auto set_sigma = [&](BodyPart part, int count, Scalar sigma) {
    if (!layout_.has(part)) return;
    const int begin = layout_.row(part) - first;
    for (int i = begin; i < begin + count; ++i) kept_->covariance[i * rows + i] = sigma * sigma;
  };
  set_sigma(BodyPart::kMountRotation, 3, unit_.sigma_turn);
  set_sigma(BodyPart::kMountPlace, 3, unit_.sigma_place);
  set_sigma(BodyPart::kDelay, 1, unit_.sigma_delay);
  set_sigma(BodyPart::kIntrinsics, Intrinsics::kRows, unit_.sigma_scale);
}

void KeptMounting::keep() {
  if (kept_ == nullptr || !filter_.body_is_sound()) return;
  const int first = first_row(), rows = num_rows();
  kept_->mounting = now();
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < rows; ++j) {
      const int row = first + (i > j ? i : j), column = first + (i > j ? j : i);
      kept_->covariance[i * rows + j] = filter_.covariance()(row, column);
    }
}

void KeptMounting::put_covariance(Scalar* covariance) const {
  const int first = first_row(), rows = num_rows(), dim = layout_.unit_rows();
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < rows; ++j) covariance[(first + i) * dim + first + j] = kept_->covariance[i * rows + j];
}

Mounting KeptMounting::now() const {
  Mounting mounting = filter_.state().mounting;
  if (!mounting.in_metres) mounting.p_C = initial().p_C;
  mounting.in_metres = true;
  return mounting;
}

}  // namespace pf
