#include "filter/moving_start.h"

#include <algorithm>
#include <cmath>

#include "filter/moving_rows.h"
#include "filter/tuning.h"
#include "geometry/small_cholesky.h"
#include "geometry/so3.h"

namespace pf {
namespace {

using namespace tuning::moving_start;
using namespace moving_rows;

constexpr int kLinear = 7;   ///< s, v_0, g
constexpr int kRefined = 9;  ///< log u, u v_0, d, b_a
/// Rows of the whitened system, three for each sum; the last column is the right side.
template <int kColumns>
struct System {
  Scalar a[3 * kMaxRows][kColumns + 1];

  void whiten(const Whitener& whitener, int n) {
    for (int axis = 0; axis < 3; ++axis)
      for (int c = 0; c <= kColumns; ++c) whitener.apply(&a[axis][c], n, 3 * (kColumns + 1));
  }
  void normal(int rows, Eigen::Matrix<Scalar, kColumns, kColumns>* A, Eigen::Matrix<Scalar, kColumns, 1>* b) const {
    A->setZero();
    b->setZero();
    for (int r = 0; r < rows; ++r)
      for (int i = 0; i < kColumns; ++i) {
        (*b)(i) += a[r][i] * a[r][kColumns];
        for (int j = 0; j < kColumns; ++j) (*A)(i, j) += a[r][i] * a[r][j];
      }
  }
};

int poses_in_mean(int count) { return (count - 2) / kMaxSums + 1; }

void accumulate(const MovingPose* pose, int count, Sums* out) {
  const int most = poses_in_mean(count);
  Vec3 V = Vec3::Zero(), S = Vec3::Zero();
  Mat3 BV = Mat3::Zero(), B = Mat3::Zero();
  Scalar t = 0;
  for (int k = 1; k < count;) {
    const int size = std::min(most, count - k);
    const Scalar part = Scalar(1) / static_cast<Scalar>(size);
    Sum& mean = out->sum[out->count++];
    mean = Sum::zero();
    for (const int end = k + size; k < end; ++k) {
      S += V * pose[k].dt + pose[k].Rp;
      V += pose[k].Rv;
      B += BV * pose[k].dt + pose[k].Rp_b;
      BV += pose[k].Rv_b;
      t += pose[k].dt;
      mean.t += part * t;
      mean.t2 += part * t * t;
      mean.variance += part * part * pose[k].sigma * pose[k].sigma;
      mean.p += part * (pose[k].p_W - pose[0].p_W);
      mean.m += part * (pose[k].m_W - pose[0].m_W);
      mean.S += part * S;
      mean.B += part * B;
    }
    out->T = mean.t;
  }
  out->poses = out->count;
}

bool solve_linear(const Sums& sums, const Whitener& whitener, Scalar* units, Vec3* v_0, Vec3* g) {
  const Sum* const sum = sums.sum;
  const int n = sums.count;
  System<kLinear> system;
  for (int k = 0; k < n; ++k)
    for (int axis = 0; axis < 3; ++axis) {
      Scalar* const row = system.a[3 * k + axis];
      std::fill(row, row + kLinear, Scalar(0));
      row[0] = sum[k].S(axis) - sum[k].m(axis);
      row[1 + axis] = sum[k].t;
      row[4 + axis] = sum[k].t2 / 2;
      row[kLinear] = sum[k].p(axis);
    }
  system.whiten(whitener, n);
  Eigen::Matrix<Scalar, kLinear, kLinear> A;
  Eigen::Matrix<Scalar, kLinear, 1> b;
  system.normal(3 * n, &A, &b);
  SmallCholesky<kLinear> cholesky;
  if (!cholesky.factor(A)) return false;
  const Eigen::Matrix<Scalar, kLinear, 1> x = cholesky.solve(b);
  *units = x(0);
  *v_0 = x.segment<3>(1);
  *g = x.segment<3>(4);
  return true;
}

/// A^T C^-1 u h [g]x of the whitened system.
Eigen::Matrix<Scalar, kRefined, 3> turned_side(const System<kRefined>& system, const Whitener& whitener,
                                               const Sums& sums, const Vec3& ug) {
  const int n = sums.count;
  const Mat3 by_rate = hat(ug);
  Eigen::Matrix<Scalar, kRefined, 3> side = Eigen::Matrix<Scalar, kRefined, 3>::Zero();
  Scalar h[kMaxRows];
  for (int k = 0; k < n; ++k) h[k] = sums.turned(k);
  whitener.apply(h, n, 1);
  for (int k = 0; k < n; ++k)
    for (int axis = 0; axis < 3; ++axis)
      for (int i = 0; i < kRefined; ++i)
        for (int j = 0; j < 3; ++j) side(i, j) += system.a[3 * k + axis][i] * h[k] * by_rate(axis, j);
  return side;
}

/// A^T C^-1 u S_e of the whitened system, S_e the double sums of what one entry (row, column) of dD_a adds to the specific force: R dD_a dv
/// and R dD_a dp. R is that of Rv_b = -R dt, which is as good over a few samples.
Eigen::Matrix<Scalar, kRefined, 1> force_side(const System<kRefined>& system, const Whitener& whitener,
                                              const MovingPose* pose, int count, const Sums& sums,
                                              const MovingRest* rest, int entry) {
  const int most = poses_in_mean(count), row = entry / 3, column = entry % 3, n = sums.count;
  Vec3 V = Vec3::Zero(), S = Vec3::Zero();
  Scalar mean[3][kMaxRows] = {};
  if (rest != nullptr)
    for (int axis = 0; axis < 3; ++axis)
      mean[axis][sums.poses] = -rest->f_b(axis, row) * -rest->f_b.col(column).dot(rest->f_W);
  int k = 1;
  for (int m = 0; m < sums.poses; ++m) {
    const int size = std::min(most, count - k);
    Vec3 sum = Vec3::Zero();
    for (const int end = k + size; k < end; ++k) {
      const Mat3 R = pose[k].Rv_b / -pose[k].dt;
      S += V * pose[k].dt + R.col(row) * R.col(column).dot(pose[k].Rp);
      V += R.col(row) * R.col(column).dot(pose[k].Rv);
      sum += S / static_cast<Scalar>(size);
    }
    for (int axis = 0; axis < 3; ++axis) mean[axis][m] = sum(axis);
  }
  Eigen::Matrix<Scalar, kRefined, 1> side = Eigen::Matrix<Scalar, kRefined, 1>::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    whitener.apply(mean[axis], n, 1);
    for (int m = 0; m < n; ++m)
      for (int i = 0; i < kRefined; ++i) side(i) += system.a[3 * m + axis][i] * mean[axis][m];
  }
  return side;
}

}  // namespace

bool solve_moving_start(const MovingPose* pose, int count, const MovingStartNoise& noise, MovingSolution* out) {
  if (count < kMinPoses || count > kMaxMovingPoses) return false;
  Sums sums;
  accumulate(pose, count, &sums);
  if (noise.rest != nullptr) sums.add(*noise.rest);
  const Sum* const sum = sums.sum;
  const int n = sums.count;
  Whitener whitener;
  Scalar u = 1;  // units of the map in a metre
  Vec3 v_0, g;
  for (int pass = 0; pass < 2; ++pass)  // the second with the noise of the samples in units of the map
    if (!whitener.factor(sums, noise, pose[0].sigma, u) || !solve_linear(sums, whitener, &u, &v_0, &g) ||
        !(u > Scalar(0)) || !(g.norm() > Scalar(0)))
      return false;
  if (!whitener.factor(sums, noise, pose[0].sigma, u)) return false;

  Quat q_WG = turn_z_to(g.normalized());
  Vec3 bias = Vec3::Zero();
  Eigen::Matrix<Scalar, kRefined, kRefined> A;
  Eigen::Matrix<Scalar, kRefined, 1> b;
  SmallCholesky<kRefined> cholesky;
  Eigen::Matrix<Scalar, kRefined, 3> turned;
  Eigen::Matrix<Scalar, kRefined, Intrinsics::kAccelRows> forced =
      Eigen::Matrix<Scalar, kRefined, Intrinsics::kAccelRows>::Zero();
  Scalar chi2 = 0;
  for (int step = 0; step <= kSteps; ++step) {
    System<kRefined> system;
    const Mat3 R_WG = q_WG.toRotationMatrix();
    g = noise.gravity * R_WG.col(2);
    Mat32 E;
    E << -noise.gravity * R_WG.col(1), noise.gravity * R_WG.col(0);
    for (int k = 0; k < n; ++k) {
      const Scalar t = sum[k].t, t2 = sum[k].t2;
      const Vec3 moved = u * (sum[k].S - sum[k].m + g * (t2 / 2) + sum[k].B * bias);
      const Vec3 r = sum[k].p - v_0 * t - moved;
      for (int axis = 0; axis < 3; ++axis) {
        Scalar* const row = system.a[3 * k + axis];
        std::fill(row, row + kRefined, Scalar(0));
        row[0] = moved(axis);  // by log u
        row[1 + axis] = t;
        for (int j = 0; j < 2; ++j) row[4 + j] = u * t2 / 2 * E(axis, j);
        for (int j = 0; j < 3; ++j) row[6 + j] = u * sum[k].B(axis, j);
        row[kRefined] = r(axis);
      }
    }
    system.whiten(whitener, n);
    system.normal(3 * n, &A, &b);
    const Scalar prior = Scalar(1) / (noise.accel_bias * noise.accel_bias);
    chi2 = prior * bias.squaredNorm();
    for (int r = 0; r < 3 * n; ++r) chi2 += system.a[r][kRefined] * system.a[r][kRefined];
    for (int i = 0; i < 3; ++i) {
      A(6 + i, 6 + i) += prior;
      b(6 + i) -= prior * bias(i);
    }
    if (!cholesky.factor(A)) return false;
    if (step == kSteps) {
      turned = turned_side(system, whitener, sums, u * g);
      for (int e = 0; noise.of_force != nullptr && e < Intrinsics::kAccelRows; ++e)
        forced.col(e) = u * force_side(system, whitener, pose, count, sums, noise.rest, e);
      break;
    }
    const Eigen::Matrix<Scalar, kRefined, 1> x = cholesky.solve(b);
    if (!x.allFinite() || !(std::abs(x(0)) < kMaxStep)) return false;
    u *= std::exp(x(0));
    v_0 += x.segment<3>(1);
    q_WG = q_WG * exp_so3(Vec3(x(4), x(5), Scalar(0)));
    bias += x.segment<3>(6);
  }
  const Eigen::Matrix<Scalar, kRefined, kRefined> identity = Eigen::Matrix<Scalar, kRefined, kRefined>::Identity();
  const Eigen::Matrix<Scalar, kRefined, kRefined> C = cholesky.solve(identity);
  out->scale = 1 / u;
  out->q_WG = q_WG;
  out->accel_bias = bias;
  out->misfit = chi2 / static_cast<Scalar>(3 * n - kRefined + 3);
  constexpr int kAt[MovingSolution::kRows] = {0, 4, 5, 6, 7, 8};
  const Scalar widen = std::max(Scalar(1), out->misfit);
  for (int i = 0; i < MovingSolution::kRows; ++i)
    for (int j = 0; j < MovingSolution::kRows; ++j) out->covariance(i, j) = widen * C(kAt[i], kAt[j]);
  // Errors are what is missing: r = A e + u h [g]x rho, so e = -C A^T .. rho.
  const Eigen::Matrix<Scalar, kRefined, 3> by_turn = -C.lazyProduct(turned);
  for (int i = 0; i < MovingSolution::kRows; ++i) out->by_turn.row(i) = by_turn.row(kAt[i]);
  out->by_turn.row(0) = -out->by_turn.row(0);
  const Eigen::Matrix<Scalar, kRefined, Intrinsics::kAccelRows> by_force = -C.lazyProduct(forced);
  for (int i = 0; i < MovingSolution::kRows; ++i) out->by_force.row(i) = by_force.row(kAt[i]);
  out->by_force.row(0) = -out->by_force.row(0);
  out->turn_variance = noise.turn * noise.turn;
  out->span = sums.T;
  for (int i = 1; i < MovingSolution::kRows; ++i)
    out->covariance(0, i) = out->covariance(i, 0) = -out->covariance(i, 0);  // log scale = -log u
  if (noise.of_force == nullptr) return true;
  out->of_force = out->by_force.lazyProduct(noise.of_force->lazyProduct(out->by_force.transpose()));
  out->covariance += out->of_force;
  return true;
}

}  // namespace pf
