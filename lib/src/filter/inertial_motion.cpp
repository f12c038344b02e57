#include "filter/inertial_motion.h"

#include <cmath>

#include "filter/inertial_rows.h"
#include "geometry/so3.h"

namespace pf {

using namespace inertial_rows;

namespace {

using Mat32 = Eigen::Matrix<Scalar, 3, 2>;
using Mat36 = Eigen::Matrix<Scalar, 3, 6>;

constexpr int kChain = 3;  ///< biases to rotation to velocity to position

/// Q = J S J^T, where J takes (phi, v, p) to (theta, p, v) by R and m_W, and biases to biases.
void set_noise(const Preintegral::Covariance& S, const Mat3& R, const Mat3& m_hat, const PartRows& rows,
               Transition* transition) {
  using Rows = Preintegral;
  Preintegral::Covariance J = Preintegral::Covariance::Identity();
  J.block<3, 3>(Rows::kPhi, Rows::kPhi) = R;
  J.block<3, 3>(Rows::kVelocity, Rows::kVelocity) = R;
  J.block<3, 3>(Rows::kPosition, Rows::kPosition) = R;
  J.block<3, 3>(Rows::kPosition, Rows::kPhi) = m_hat.lazyProduct(R);
  const Preintegral::Covariance Q = Preintegral::transformed(J, S);
  const int to[Rows::kRows / 3] = {Body::kTheta, rows.velocity, Body::kPosition, rows.gyro, rows.accel};
  for (int a = 0; a < Rows::kRows / 3; ++a)
    for (int b = 0; b < Rows::kRows / 3; ++b)
      set_block<3>(transition->Q, rows.dim, to[a], to[b], Mat3(Q.block<3, 3>(3 * a, 3 * b)));
}

/// F by the mounting. dv_W, dp_W: what the unit's specific force has added, which rotates with it; zero where that is not used.
void set_by_mounting(const Body& body, const Mounting& mounting, const PartRows& rows, const Vec3& dv_W,
                     const Vec3& dp_W, const Mat3& m_hat, Transition* transition) {
  if (rows.turn < 0 && rows.place < 0) return;
  const Mat3 R_before = body.q_WC.toRotationMatrix();
  const Mat3 turned = R_before - transition->mean.q_WC.toRotationMatrix();
  if (rows.turn >= 0) {
    set_block<3>(transition->F, rows.dim, Body::kTheta, rows.turn, turned);
    set_block<3>(transition->F, rows.dim, rows.velocity, rows.turn, Mat3(-hat(dv_W).lazyProduct(R_before)));
    set_block<3>(transition->F, rows.dim, Body::kPosition, rows.turn,
                 Mat3(m_hat.lazyProduct(turned) - hat(dp_W).lazyProduct(R_before)));
  }
  if (rows.place >= 0 && mounting.in_metres) set_block<3>(transition->F, rows.dim, Body::kPosition, rows.place, turned);
}

/// By the errors of the intrinsics, through (e_phi, e_dv, e_dp). by_force: what the specific force does counts.
void set_by_intrinsics_of(const Preintegral& samples, const Mat3& R, const Mat3& m_hat, bool by_force,
                          const PartRows& rows, Transition* transition) {
  if (rows.intrinsics < 0 || !samples.intrinsics().open) return;
  using By = Eigen::Matrix<Scalar, 3, Intrinsics::kRows>;
  const Preintegral::ByIntrinsics& D = samples.by_intrinsics();
  const By by_phi = R.lazyProduct(D.topRows<3>());
  By by_p = m_hat.lazyProduct(by_phi);
  if (by_force) by_p += R.lazyProduct(D.bottomRows<3>());
  set_by_intrinsics(transition, Body::kTheta, 0, by_phi);
  set_by_intrinsics(transition, Body::kPosition, 0, by_p);
  if (by_force) set_by_intrinsics(transition, rows.velocity, 0, By(R.lazyProduct(D.middleRows<3>(3))));
}

/// Pose and velocity of the mean, from where the unit goes.
void set_mean(const Mounting& mounting, const Mat3& R, const Preintegral& samples, const Vec3& p_B, const Vec3& v,
              Transition* transition, Vec3* m_W) {
  const Mat3 R_WC = (R * samples.R()) * mounting.R_CB.transpose();
  *m_W = R_WC * mounting.p_C;
  transition->mean.q_WC = Quat(R_WC);
  transition->mean.q_WC.normalize();
  transition->mean.p_W = p_B - *m_W;
  transition->mean.v_W = v;
}

}  // namespace

void predict_inertial(const Body& body, const BodyLayout& layout, const Mounting& mounting, const Preintegral& samples,
                      Scalar gravity, Transition* transition) {
  const PartRows rows(layout);
  clear(transition, body, rows.dim);
  const Scalar T = samples.dt(), T2 = T * T / 2;
  const Mat3 R = body.q_WC.toRotationMatrix() * mounting.R_CB, R_WG = body.q_WG.toRotationMatrix();
  const Vec3 g_W = gravity * R_WG.col(2), dv_W = R * samples.v(), dp_W = R * samples.p();
  const Vec3 m_before = body.q_WC * mounting.p_C;
  Vec3 m_after;
  set_mean(mounting, R, samples, body.p_W + m_before + body.v_W * T + g_W * T2 + dp_W, body.v_W + g_W * T + dv_W,
           transition, &m_after);

  const Mat3 m_hat = hat(m_after);
  const auto& D = samples.by_bias();
  const Mat36 phi = R.lazyProduct(D.topRows<3>()), by_v = R.lazyProduct(D.middleRows<3>(3));
  const Mat36 by_p = R.lazyProduct(D.bottomRows<3>()) + m_hat.lazyProduct(phi);
  Mat32 E;
  E << -gravity * R_WG.col(1), gravity * R_WG.col(0);
  Scalar* F = transition->F;
  set_block<6>(F, rows.dim, Body::kTheta, rows.gyro, phi);  // the accelerometer's bias follows
  set_block<3>(F, rows.dim, rows.velocity, Body::kTheta, -hat(dv_W));
  set_block<6>(F, rows.dim, rows.velocity, rows.gyro, by_v);
  set_block<2>(F, rows.dim, rows.velocity, rows.gravity, T * E);
  set_block<3>(F, rows.dim, Body::kPosition, Body::kTheta, hat(m_after - m_before - dp_W));
  set_block<3>(F, rows.dim, Body::kPosition, rows.velocity, T * Mat3::Identity());
  set_block<6>(F, rows.dim, Body::kPosition, rows.gyro, by_p);
  set_block<2>(F, rows.dim, Body::kPosition, rows.gravity, T2 * E);
  set_by_mounting(body, mounting, rows, dv_W, dp_W, m_hat, transition);
  if (rows.delay >= 0) {
    const Vec3 by_phi = R * samples.by_delay().head<3>();
    set_block<1>(F, rows.dim, Body::kTheta, rows.delay, by_phi);
    set_block<1>(F, rows.dim, rows.velocity, rows.delay, Vec3(R * samples.by_delay().segment<3>(3)));
    set_block<1>(F, rows.dim, Body::kPosition, rows.delay, Vec3(R * samples.by_delay().tail<3>() + m_hat * by_phi));
  }
  set_by_intrinsics_of(samples, R, m_hat, true, rows, transition);
  set_noise(samples.covariance(), R, m_hat, rows, transition);
}

namespace {

/// Rotation by `samples`, with covariance S; translation with white accelerations.
void predict_by_rotation(const Body& body, const BodyLayout& layout, const Mounting& mounting,
                         const Preintegral& samples, Preintegral::Covariance S, Scalar linear_density,
                         Transition* transition) {
  const PartRows rows(layout);
  clear(transition, body, rows.dim);
  const Scalar T = samples.dt(), a = linear_density * linear_density;
  const Mat3 R = body.q_WC.toRotationMatrix() * mounting.R_CB;
  const Vec3 m_before = body.q_WC * mounting.p_C;
  Vec3 m_after;
  set_mean(mounting, R, samples, body.p_W + m_before + body.v_W * T, body.v_W, transition, &m_after);

  const Mat3 m_hat = hat(m_after);
  const Mat3 phi = R.lazyProduct(samples.by_bias().topLeftCorner<3, 3>());
  set_block<3>(transition->F, rows.dim, Body::kTheta, rows.gyro, phi);
  set_block<3>(transition->F, rows.dim, Body::kPosition, Body::kTheta, hat(m_after - m_before));
  set_block<3>(transition->F, rows.dim, Body::kPosition, rows.velocity, T * Mat3::Identity());
  set_block<3>(transition->F, rows.dim, Body::kPosition, rows.gyro, m_hat.lazyProduct(phi));
  set_by_mounting(body, mounting, rows, Vec3::Zero(), Vec3::Zero(), m_hat, transition);
  if (rows.delay >= 0) {
    const Vec3 by_phi = R * samples.by_delay().head<3>();
    set_block<1>(transition->F, rows.dim, Body::kTheta, rows.delay, by_phi);
    set_block<1>(transition->F, rows.dim, Body::kPosition, rows.delay, Vec3(m_hat * by_phi));
  }
  set_by_intrinsics_of(samples, R, m_hat, false, rows, transition);
  S.middleRows<6>(Preintegral::kVelocity).setZero();
  S.middleCols<6>(Preintegral::kVelocity).setZero();
  for (int i = 0; i < 3; ++i) {
    const int v = Preintegral::kVelocity + i, p = Preintegral::kPosition + i;
    S(v, v) = a * T;
    S(p, p) = a * T * T * T / 3;
    S(v, p) = S(p, v) = a * T * T / 2;
  }
  set_noise(S, R, m_hat, rows, transition);
}

/// What the intrinsics have added was added behind F_made, and goes the same way:   B <- B - F F_made^-1 B_made
void replace_intrinsics(const Transition& made, const Scalar* X, Transition* transition) {
  if (!made.has_intrinsics) return;
  constexpr int kColumns = Intrinsics::kRows;
  const int dim = made.dim;
  if (!transition->has_intrinsics)
    for (int i = 0; i < dim * kColumns; ++i) transition->by_intrinsics[i] = Scalar(0);
  transition->has_intrinsics = true;
  for (int i = 0; i < dim; ++i)
    for (int k = 0; k < dim; ++k)
      for (int j = 0; j < kColumns; ++j)
        transition->by_intrinsics[i * kColumns + j] -= X[i * dim + k] * made.by_intrinsics[k * kColumns + j];
}

}  // namespace

void predict_rotation_only(const Body& body, const BodyLayout& layout, const Mounting& mounting,
                           const Preintegral& samples, Scalar linear_density, Transition* transition) {
  predict_by_rotation(body, layout, mounting, samples, samples.covariance(), linear_density, transition);
}

/// With N = F_made - I and N^4 = 0:   F F_made^-1 = F - (F - (F - F N) N) N
void replace_transition(const Transition& made, Transition* transition) {
  constexpr int kMax = BodyLayout::kMaxDynamicRows;
  const int dim = made.dim;
  Scalar X[kMax * kMax], row[kMax];
  const Scalar* F = transition->F;
  for (int i = 0; i < dim * dim; ++i) X[i] = F[i];
  for (int round = 0; round < kChain; ++round)
    for (int i = 0; i < dim; ++i) {
      for (int j = 0; j < dim; ++j) {
        row[j] = F[i * dim + j] + X[i * dim + j];
        for (int k = 0; k < dim; ++k) row[j] -= X[i * dim + k] * made.F[k * dim + j];
      }
      for (int j = 0; j < dim; ++j) X[i * dim + j] = row[j];
    }
  for (int i = 0; i < dim * dim; ++i) transition->F[i] = X[i];
  replace_intrinsics(made, X, transition);
  for (int i = 0; i < dim; ++i) {
    for (int j = 0; j < dim; ++j) {
      row[j] = Scalar(0);
      for (int k = 0; k < dim; ++k) row[j] += X[i * dim + k] * made.Q[k * dim + j];
    }
    for (int j = 0; j < dim; ++j)
      for (int k = 0; k < dim; ++k) transition->Q[i * dim + j] -= row[k] * X[j * dim + k];
  }
}

/// Of the rate: white accelerations b over T give e_b variance b T, and with phi by it through G, which is T of a rotation:
/// phi b T / 3 G G^T, between them b / 2 G T.
void predict_without_samples(const Body& body, const BodyLayout& layout, const Mounting& mounting, Scalar dt,
                             const MotionNoise& noise, Transition* transition) {
  Intrinsics intrinsics = mounting.intrinsics;
  intrinsics.open = false;  // the rate is what it is, whatever the intrinsics are
  Preintegral path(ImuNoise(), Vec3::Zero(), Vec3::Zero(), intrinsics);
  path.coast(dt, mounting.R_CB.transpose() * body.w_C, Vec3::Zero(), Scalar(0), Scalar(0));
  const Mat3 G = path.by_bias().topLeftCorner<3, 3>();
  const Scalar b = noise.angular * noise.angular;
  Preintegral::Covariance S = Preintegral::Covariance::Zero();
  S.block<3, 3>(Preintegral::kPhi, Preintegral::kPhi) = b * dt / 3 * G.lazyProduct(G.transpose());
  S.block<3, 3>(Preintegral::kPhi, Preintegral::kGyroBias) = b * dt / 2 * G;
  S.block<3, 3>(Preintegral::kGyroBias, Preintegral::kPhi) = b * dt / 2 * G.transpose();
  S.block<3, 3>(Preintegral::kGyroBias, Preintegral::kGyroBias) = b * dt * Mat3::Identity();
  predict_by_rotation(body, layout, mounting, path, S, noise.linear, transition);
}

}  // namespace pf
