#include <algorithm>
#include <cmath>

#include "filter/filter.h"
#include "filter/state_rows.h"
#include "filter/tuning.h"
#include "geometry/small_cholesky.h"
#include "geometry/so3.h"

/// The update.

namespace pf {

const Measurement* Filter::views_of(const PixelMeasurement* z, int count) {
  for (int i = 0; i < count; ++i) view_[i] = z[i].view();
  return view_;
}

RowRange Filter::considered(EstimatedRows rows) const {
  RowRange range = blocks_.held();
  if (!rows.map) range = {std::min(state_.layout.dynamic_rows(), range.begin), dim()};
  if (!rows.motion) range.begin = 0;
  return range;
}

bool Filter::solve_update(const Measurement* z, int count, const unsigned char* keep, Scalar* nis, EstimatedRows rows) {
  Scalar sum;
  const Scalar* dx = blocks_.gain(z, count, keep, considered(rows), rows.partly, &sum);
  if (dx == nullptr) return false;
  if (nis != nullptr) *nis = sum;
  return is_step(dx);
}

void Filter::commit_update() {
  transport_.skip();
  ScaleRow l;
  if (keep_gauge_) {
    scale_row(&l);
    transport_.begin(state_, blocks_, l);
  }
  apply_error(state_, blocks_, blocks_.step());
  if (keep_gauge_) transport_.finish(state_, blocks_);
  blocks_.downdate(transport_.U(), transport_.G(), transport_.rows());
  // In float the diagonal gets back what rounding may have taken from it. Not in double: a part of a variance against W, which may be
  // metres along a street, is much of what is known of a point against its neighbours (lib/docs/theory/float.md).
  if constexpr (sizeof(Scalar) == sizeof(float)) {
    blocks_.keep_rounding();
    blocks_.grow(tuning::apart::kGrowth * std::sqrt(static_cast<Scalar>(blocks_.dim())));
  }
  if (keeps_apart()) end_update_apart(l);
  if (told_updates_ > 0) --told_updates_;
}

/// The mean alone moves between these two: the gauge of the covariance goes with it (transport.h).
void Filter::begin_move() {
  if (!keep_gauge_) return;
  ScaleRow l;
  scale_row(&l);
  transport_.begin(state_, blocks_, l);
}

void Filter::end_move() {
  if (!keep_gauge_) return;
  blocks_.forget_gain();
  transport_.finish(state_, blocks_);
  blocks_.add_shared(transport_.U(), transport_.G(), transport_.rows());
}

/// The pose moves to near and back with its mean alone: what is known of it against the estimate stays,
///
///   dx = K (z - h(near) - H e),   x = near [+] (e + dx),   e = estimate [-] near
bool Filter::finish_update_near(const Measurement& z, const Body& near, Scalar* nis) {
  const Body estimate = state_.body;
  const auto move_to = [&](const Body& pose) {
    begin_move();
    state_.body.q_WC = pose.q_WC;
    state_.body.p_W = pose.p_W;
    end_move();
  };
  move_to(near);
  begin_update(&z, 1);
  if (!solve_update(&z, 1, nullptr, nis)) {
    move_to(estimate);
    return false;
  }
  Vec6 e;
  e << log_so3(estimate.q_WC * near.q_WC.conjugate()), estimate.p_W - near.p_W;
  blocks_.shift_step(e);
  commit_update();
  return true;
}

bool Filter::pose_nis(Scalar* nis, Scalar* of_rotation) const {
  Mat6 A = Mat6::Zero();
  Vec6 b = Vec6::Zero();
  for (int k = 0; k < blocks_.gained_rows(); ++k) {
    const Vec6 a = Eigen::Map<const Vec6>(blocks_.whitened(k));
    A += a * a.transpose();
    b += a * blocks_.whitened_innovation()[k];
  }
  SmallCholesky<Body::kPoseDim> cholesky;
  if (!cholesky.factor(A)) return false;
  SmallCholesky<3> rotation;
  if (!rotation.factor(Mat3(A.topLeftCorner<3, 3>()))) return false;
  const Vec3 b_theta = b.head<3>();
  *nis = b.dot(cholesky.solve<1>(b));
  *of_rotation = b_theta.dot(rotation.solve<1>(b_theta));
  return true;
}

}  // namespace pf
