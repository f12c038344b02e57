#include <algorithm>
#include <cmath>

#include "filter/filter.h"
#include "filter/inertial_rows.h"
#include "filter/moving_start.h"
#include "geometry/so3.h"

/// A map up to scale becomes one in metres (lib/docs/theory/inertial.md).

namespace pf {
namespace {

/// What a block's values and rows are multiplied by when lengths are by s.
void scale_block(Block* block, Scalar s, Scalar* factor) {
  const auto lengths = [&](int count) {
    for (int i = 0; i < count; ++i) {
      block->value[i] *= s;
      factor[i] = s;
    }
  };
  switch (block->kind) {
    case BlockKind::kAnchor:
    case BlockKind::kPoint:
      lengths(3);
      break;
    case BlockKind::kPlanePoint:
      lengths(2);
      break;
    case BlockKind::kInverseDepth: {
      InverseDepth d = block->inverse_depth();
      d.rho /= s;
      block->set_inverse_depth(d);
      factor[2] = 1 / s;
      break;
    }
    case BlockKind::kPlane: {  // (a, b, h)
      const Vec3 x = block->xyz();
      block->set_xyz(Vec3(x(0), x(1), s * x(2)));
      factor[2] = s;
      break;
    }
    case BlockKind::kPointGroup: {
      PointGroup group = block->group();
      group.t *= s;
      group.lambda += std::log(s);
      block->set_group(group);
      factor[0] = factor[1] = s;
      break;
    }
    default:
      break;
  }
}

/// Gravity and the accelerometer's bias, and what they have in common with the camera's rotation now.
struct TurnedStart {
  Eigen::Matrix<Scalar, 5, 3> by_theta;  ///< beside d = E^T theta
  Eigen::Matrix<Scalar, 5, 5> covariance;
  Eigen::Matrix<Scalar, 5, 1> of_scale;  ///< covariance with the log scale, but for the part by theta
};

/// The rate rho at which the poses of a start turned away from the truth is what the camera's rotation has in common with them:
/// theta = rho T and what was there before, so rho = a theta + rho', a = s_rho^2 T / s_theta^2, at most 1 / T. Gravity is right at T / 2:
///
///   d = E^T (theta - rho T / 2) + J_d rho + n,   b_a = J_b rho + n
TurnedStart apart_from_rotation(const MovingSolution& start, const Mat3& R_WG, Scalar variance_theta) {
  TurnedStart out;
  Eigen::Matrix<Scalar, 5, 3> J = start.by_turn.bottomRows<5>();
  const Eigen::Matrix<Scalar, 1, 3> J_s = start.by_turn.row(0);
  const Scalar of_rate = start.turn_variance;
  // What the intrinsics do comes through them.
  out.covariance = start.covariance.bottomRightCorner<5, 5>() - of_rate * J.lazyProduct(J.transpose()) -
                   start.of_force.bottomRightCorner<5, 5>();
  out.of_scale = start.covariance.block<5, 1>(1, 0) - of_rate * J.lazyProduct(J_s.transpose());
  J.topRows<2>() -= start.span / 2 * R_WG.leftCols<2>().transpose();
  const Scalar a = variance_theta > Scalar(0) && start.span > Scalar(0)
                       ? std::min(of_rate * start.span / variance_theta, 1 / start.span)
                       : Scalar(0);
  const Scalar left = std::max(Scalar(0), of_rate - a * a * variance_theta);
  out.by_theta = a * J;
  out.covariance += left * J.lazyProduct(J.transpose());
  out.of_scale += left * J.lazyProduct(J_s.transpose());
  return out;
}

}  // namespace

/// Values of all but the body, and what their rows are multiplied by. Planes that are apart stay where they are.
void Filter::scale_map(Scalar s, Scalar* factor) {
  for (int k = 0; k < state_.slots; ++k) {
    Block& block = state_.block[k];
    if (block.kind == BlockKind::kPlane) state_.plane_frame[block.frame].o_W *= s;
    if (block.kind == BlockKind::kReferenceCamera) {
      const int first = first_row(k) + Body::kPosition;
      for (int i = 0; i < 3; ++i) {
        block.value[4 + i] *= s;
        factor[first + i] = s;
      }
    } else if (block.size > 0) {
      scale_block(&block, s, factor + first_row(k));
    }
  }
}

/// Scales mean and P to metres, then sets the log scale, gravity and the accelerometer's bias with the covariance of `start`, which
/// replaces P's variance of the scale:
///
///   P <- (I - N_s l) P (I - N_s l)^T + C_ss N_s N_s^T + N_s c^T + c N_s^T       c: C_(g a)s over the rows of gravity and bias
///
/// Gravity and bias depend on the rotation of the poses (above); without their drift: d = E^T theta + n. The velocity is that of the unit's
/// origin, v = v_C + R (w x m), with the uncertainty of w.
void Filter::set_metric(const MovingSolution& start, const Mounting& mounting) {
  using namespace inertial_rows;
  const Scalar s = start.scale;
  const PartRows rows(state_.layout);
  Scalar* factor = blocks_.row_factors();
  for (int i = 0; i < 3; ++i) factor[Body::kPosition + i] = factor[rows.velocity + i] = s;
  Body body = state_.body;
  body.p_W *= s;
  body.v_W = s * body.v_W + body.q_WC * (body.w_C.cross(mounting.p_C));
  scale_map(s, factor);
  blocks_.scale_rows(factor);

  Transition transition;
  clear(&transition, body, rows.dim);
  transition.mean.accel_bias += start.accel_bias;
  transition.mean.q_WG = start.q_WG;
  // e_v = e_v_C - [R (w x m)]x theta - R [m]x e_w,   e_w = R_CB (dD_w (gyro - b_g) - D_w e_b)
  const Mat3 R = body.q_WC.toRotationMatrix();
  const Mat3 by_theta = -hat(Vec3(R * body.w_C.cross(mounting.p_C)));
  const Mat3 by_bias = R.lazyProduct(hat(mounting.p_C)).lazyProduct(mounting.rate_by_reading());
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      transition.F[(rows.velocity + i) * rows.dim + Body::kTheta + j] = by_theta(i, j);
      transition.F[(rows.velocity + i) * rows.dim + rows.gyro + j] = by_bias(i, j);
    }
  forget_rows(&transition, rows.accel, 5);  // gravity follows
  set_gravity_by_rotation(rows, false, &transition);
  const Scalar variance_theta = (variance(Body::kTheta) + variance(Body::kTheta + 1) + variance(Body::kTheta + 2)) / 3;
  const TurnedStart turned = apart_from_rotation(start, transition.mean.q_WG.toRotationMatrix(), variance_theta);
  constexpr int kAt[5] = {3, 4, 0, 1, 2};  // (d, b_a) behind the scale: rows from accel on
  Scalar* const Q = transition.Q;
  for (int i = 0; i < 5; ++i)
    for (int j = 0; j < 5; ++j) Q[(rows.accel + kAt[i]) * rows.dim + rows.accel + kAt[j]] = turned.covariance(i, j);
  for (int i = 0; i < 5; ++i)
    for (int j = 0; j < 3; ++j)
      transition.F[(rows.accel + kAt[i]) * rows.dim + Body::kTheta + j] += turned.by_theta(i, j);
  if (rows.intrinsics >= 0) {
    set_by_intrinsics(
        &transition, rows.velocity, 0,
        Eigen::Matrix<Scalar, 3, Intrinsics::kGyroRows>(
            -R.lazyProduct(hat(mounting.p_C))
                 .lazyProduct(mounting.R_CB.lazyProduct(Intrinsics::gyro_by_errors(mounting.reading_of(body.w_C))))));
    set_by_intrinsics(&transition, rows.accel, Intrinsics::kGyroRows,
                      MovingSolution::ByForce<3>(start.by_force.bottomRows<3>()));
    set_by_intrinsics(&transition, rows.gravity, Intrinsics::kGyroRows,
                      MovingSolution::ByForce<2>(start.by_force.middleRows<2>(1)));
  }
  predict(transition);
  state_.mounting = mounting;

  replace_scale(start.covariance(0, 0));
  const Scalar* const N = transport_.scale_direction(state_, blocks_);
  Scalar* const shared = blocks_.row_factors();
  for (int i = 0; i < blocks_.ld(); ++i) shared[i] = Scalar(0);
  for (int i = 0; i < 5; ++i) shared[rows.accel + kAt[i]] = turned.of_scale(i);
  if (rows.intrinsics >= 0) {  // what the scale has in common with them, and through them with gravity and bias
    const int first = rows.intrinsics + Intrinsics::kGyroRows;
    for (int i = 0; i < Intrinsics::kAccelRows; ++i)
      for (int j = 0; j < Intrinsics::kAccelRows; ++j)
        shared[first + i] +=
            covariance()(std::max(first + i, first + j), std::min(first + i, first + j)) * start.by_force(0, j);
  }
  blocks_.add_shared(N, shared, 1);
  set_metric();
}

}  // namespace pf
