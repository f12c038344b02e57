#include "keyframe_slam/tracking/motion.h"

#include <algorithm>
#include <cmath>

#include "base/elapsed.h"
#include "frame/speed_limits.h"
#include "geometry/small_cholesky.h"
#include "geometry/so3.h"
#include "keyframe_slam/tracking/tuning.h"

namespace pf {
namespace {

constexpr std::int64_t kMaxGapNs = 2000000000;  // [ns] longest time between frames that a prediction covers
constexpr int kVelocity = 6;                    // first row of (v, w)

/// Of three axes.
Scalar largest_variance(const KeyframeMotion::Covariance& P, int first_row) {
  return P.diagonal().segment<3>(first_row).maxCoeff();
}

}  // namespace

void KeyframeMotion::set(const Body& body, const Mat6& pose, Scalar speed, Scalar rate) {
  data_.body = body;
  data_.measured.is_set = false;
  data_.max_nis = 0;
  data_.P.setZero();
  data_.P.topLeftCorner<6, 6>() = pose;
  if (!has_velocity()) return;
  for (int i = 0; i < 3; ++i) {
    data_.P(kVelocity + i, kVelocity + i) = speed * speed;
    data_.P(kVelocity + 3 + i, kVelocity + 3 + i) = rate * rate;
  }
}

void KeyframeMotion::set_pose_covariance(const Mat6& pose) {
  data_.P.topRightCorner<6, 6>().setZero();
  data_.P.bottomLeftCorner<6, 6>().setZero();
  data_.P.topLeftCorner<6, 6>() = pose;
}

void KeyframeMotion::predict(const Body& body, Scalar dt, const MotionNoise& noise, Transition* transition) const {
  if (has_velocity())
    predict_constant_velocity(body, layout(), dt, noise, transition);
  else
    predict_constant_position(body, layout(), dt, noise, transition);
}

/// P+ = F P Fᵀ + Q over the rows that move. In float the diagonal gets back what rounding may have taken from it
/// (lib/docs/theory/float.md).
void KeyframeMotion::apply(const Transition& transition, Data* data) {
  const int dim = transition.dim;
  Covariance FP = Covariance::Zero(), P = Covariance::Zero();
  for (int i = 0; i < dim; ++i)
    for (int j = 0; j < dim; ++j)
      for (int k = 0; k < dim; ++k) FP(i, j) += transition.F[i * dim + k] * data->P(k, j);
  for (int i = 0; i < dim; ++i)
    for (int j = 0; j < dim; ++j) {
      Scalar sum = transition.Q[i * dim + j];
      for (int k = 0; k < dim; ++k) sum += FP(i, k) * transition.F[j * dim + k];
      P(i, j) = sum;
    }
  data->P = (P + P.transpose()) / 2;
  if constexpr (sizeof(Scalar) == sizeof(float)) data->P.diagonal() *= 1 + tuning::keyframe_motion::kGrowth;
  data->body = transition.mean;
}

void KeyframeMotion::advance(std::int64_t before_ns, std::int64_t t_ns, bool coasting_or_lost, bool nothing_measured) {
  const Scalar dt = static_cast<Scalar>(seconds(std::min(elapsed_ns(before_ns, t_ns), kMaxGapNs)));
  data_.measured.is_set = false;
  data_.max_nis = 0;
  if (data_.dv_C != Vec3::Zero() || data_.dw_C != Vec3::Zero()) {
    Transition control;
    change_velocity(data_.body, layout(), data_.dv_C, data_.dw_C, &control);
    apply(control, &data_);
    forget_control();
  }
  MotionNoise noise = settings_.motion_noise;
  if (coasting_or_lost) {
    if (has_velocity() && nothing_measured) damp(dt);
    const int linear = has_velocity() ? kVelocity : Body::kPosition;
    noise = limited_noise(noise, has_velocity(), largest_variance(data_.P, Body::kTheta),
                          largest_variance(data_.P, linear));
  }
  Transition transition;
  predict(data_.body, dt, noise, &transition);
  apply(transition, &data_);
}

/// Lets the speed decay while nothing is measured.
void KeyframeMotion::damp(Scalar dt) {
  Mat6 P_speed = data_.P.bottomRightCorner<6, 6>();
  Vec3 rate = data_.body.w_C;
  limit_speed(dt, largest_variance(data_.P, Body::kTheta), largest_variance(data_.P, Body::kPosition), &rate, &P_speed);
  Transition transition;
  damp_speed(data_.body, layout(), speed_decay(dt), rate, P_speed, &transition);
  apply(transition, &data_);
}

bool KeyframeMotion::correct(const Quat& q_WC, const Vec3& p_W, const Wide6& R) {
  const Wide6 A = data_.P.topLeftCorner<6, 6>().cast<double>(), B = data_.P.bottomLeftCorner<6, 6>().cast<double>();
  SmallCholesky<6, double> S;
  if (!S.factor(Wide6(A + R))) return false;
  Vec6 e;
  e << log_so3(q_WC * data_.body.q_WC.conjugate()), p_W - data_.body.p_W;
  // K_p = A S⁻¹, I - K_p = R S⁻¹, and K_v = B S⁻¹.
  const Wide6 K_p = S.solve<6>(A).transpose(), rest = S.solve<6>(R).transpose(),
              K_v = S.solve<6>(B.transpose()).transpose();
  const Wide6 pose =
      rest.lazyProduct(A).lazyProduct(rest.transpose()) + K_p.lazyProduct(R).lazyProduct(K_p.transpose());
  const Wide6 speed = data_.P.bottomRightCorner<6, 6>().cast<double>() - K_v.lazyProduct(B.transpose());
  const Mat6 across = K_v.lazyProduct(R).cast<Scalar>();
  data_.P.topLeftCorner<6, 6>() = ((pose + pose.transpose()) / 2).cast<Scalar>();
  data_.P.bottomRightCorner<6, 6>() = ((speed + speed.transpose()) / 2).cast<Scalar>();
  data_.P.bottomLeftCorner<6, 6>() = across;
  data_.P.topRightCorner<6, 6>() = across.transpose();
  const Vec6 dv = K_v.lazyProduct(e.cast<double>()).cast<Scalar>();
  data_.body.q_WC = q_WC;
  data_.body.p_W = p_W;
  SmallCholesky<6, double> predicted;
  if (settings_.inertial && predicted.factor(A)) {
    data_.measured = {true, q_WC, p_W, R.cast<Scalar>()};
    const Vec6 more = R.lazyProduct(predicted.solve<1>(Eigen::Matrix<double, 6, 1>(e.cast<double>()))).cast<Scalar>();
    data_.measured.q_WC = (exp_so3(more.head<3>()) * q_WC).normalized();
    data_.measured.p_W += more.tail<3>();
  }
  if (has_velocity()) {
    data_.body.v_W += dv.head<3>();
    data_.body.w_C += dv.tail<3>();
  }
  return true;
}

bool KeyframeMotion::is_sound() const {
  const Body& b = data_.body;
  Scalar sum = b.q_WC.coeffs().sum() + b.p_W.sum() + b.v_W.sum() + b.w_C.sum();
  for (int i = 0; i < kMaxRows; ++i) {
    if (!(data_.P(i, i) >= Scalar(0))) return false;
    sum += data_.P(i, i);
  }
  return std::isfinite(sum);
}

void KeyframeMotion::predict_pose(std::int64_t now_ns, std::int64_t t_ns, Body* body, Mat6* covariance) const {
  Data data = data_;
  if (t_ns > now_ns) {
    Transition transition;
    predict(data.body, static_cast<Scalar>(seconds(elapsed_ns(now_ns, t_ns))), settings_.motion_noise, &transition);
    apply(transition, &data);
  }
  *body = data.body;
  *covariance = data.P.topLeftCorner<6, 6>();
}

void KeyframeMotion::move(const Similarity& T) {
  data_.body.q_WC = (T.q * data_.body.q_WC).normalized();
  data_.body.p_W = T.of(data_.body.p_W);
  data_.body.v_W = T.s * (T.q * data_.body.v_W);
  const Mat3 R = T.q.toRotationMatrix();
  Covariance J = Covariance::Identity();  // the velocity of rotation is in camera axes
  J.topLeftCorner<3, 3>() = R;
  J.block<3, 3>(3, 3) = J.block<3, 3>(6, 6) = T.s * R;
  data_.P = Covariance(J.lazyProduct(data_.P)).lazyProduct(J.transpose());
}

}  // namespace pf
