#include "filter/gauge_prior.h"

#include "geometry/so3.h"

namespace pf {
namespace {

constexpr int kMaxPartRows = BodyLayout::kMaxDynamicRows;
static_assert(kMaxPartRows >= Block::kMaxRows);

/// Gauge rows of the part's block: of the body those of the part that begins there. Rows that a gauge leaves alone are zero.
GaugeRowsOf<kMaxPartRows> rows_of(const State& state, const Part& part) {
  GaugeRowsOf<kMaxPartRows> N = GaugeRowsOf<kMaxPartRows>::Zero();
  if (part.block != kBodyBlock) {
    const GaugeRows all = gauge_rows(state, state.block[part.block]);
    for (int i = 0; i < part.size; ++i) N.row(i) = all.row(part.offset + i);
    return N;
  }
  for_each_body_gauge(state.body, state.layout, state.mounting, [&](int first, int size, const GaugeRowsOf<3>& rows) {
    for (int i = 0; i < size; ++i) {
      const int at = first + i - part.offset;
      if (at >= 0 && at < part.size) N.row(at) = rows.row(i);
    }
  });
  return N;
}

}  // namespace

void GaugePrior::clear() {
  V_.setZero();
  any_ = false;
}

void GaugePrior::add_scale(Scalar variance, const Vec3& pivot) {
  Eigen::Matrix<Scalar, gauge::kDirections, 1> u = Eigen::Matrix<Scalar, gauge::kDirections, 1>::Zero();
  u.segment<3>(gauge::kTranslation) = -pivot;
  u(gauge::kScale) = 1;
  V_ += variance * u * u.transpose();
  any_ = true;
}

/// e_theta = g_theta,  e_p = g_t - [p]x g_theta:   g_t = e_p + [p]x e_theta
void GaugePrior::set_pose(const State& state, const Scalar* covariance, int ld) {
  Mat6 C, from_pose = Mat6::Zero();
  for (int i = 0; i < Body::kPoseDim; ++i)
    for (int j = 0; j < Body::kPoseDim; ++j) C(i, j) = covariance[i * ld + j];
  from_pose.block<3, 3>(gauge::kTranslation, Body::kPosition).setIdentity();
  from_pose.block<3, 3>(gauge::kTranslation, Body::kTheta) = hat(state.body.p_W);
  from_pose.block<3, 3>(gauge::kRotation, Body::kTheta).setIdentity();
  const Mat6 AC = from_pose.lazyProduct(C);
  V_.topLeftCorner<6, 6>() = AC.lazyProduct(from_pose.transpose());
  any_ = true;
}

void GaugePrior::add_leading(const State& state, int rows, Scalar* covariance) const {
  const GaugeRowsOf<kMaxPartRows> N = rows_of(state, Part::body(0, rows));
  const GaugeRowsOf<kMaxPartRows> NV = N.lazyProduct(V_);
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < rows; ++j) covariance[i * rows + j] += NV.row(i).dot(N.row(j));
}

void GaugePrior::project(const State& state, const Rows& J, Scalar* JN) {
  const int columns = J.columns();
  for (int i = 0; i < J.rows * gauge::kDirections; ++i) JN[i] = Scalar(0);
  for (int p = 0, column = 0; p < J.parts; ++p) {
    const GaugeRowsOf<kMaxPartRows> N = rows_of(state, J.part[p]);
    for (int i = 0; i < J.part[p].size; ++i, ++column)
      for (int r = 0; r < J.rows; ++r)
        for (int d = 0; d < gauge::kDirections; ++d) JN[d * J.rows + r] += J.h[r * columns + column] * N(i, d);
  }
}

}  // namespace pf
