#include "slam/body_motion.h"

#include <cmath>

#include "base/elapsed.h"

namespace pf {
namespace {

constexpr Scalar kSpeedDecay = Scalar(0.25);  ///< [s] time constant of a speed that is not measured
constexpr Scalar kMaxRotationSigma =
    Scalar(0.5);  ///< [rad] beyond this standard deviation the covariance stops growing

}  // namespace

void BodyMotion::advance(std::int64_t gap_ns, bool coasting_or_lost, bool nothing_measured) {
  // After kMaxGapNs no motion is predictable, and the covariance grows no further.
  const Scalar dt = static_cast<Scalar>(static_cast<double>(gap_ns < kMaxGapNs ? gap_ns : kMaxGapNs) * 1e-9);
  MotionNoise noise = settings_.motion_noise;
  if (coasting_or_lost) {
    // A hand does not keep its speed for long, and half a radian of rotation uncertainty already means searching everywhere.
    // Without these limits, one second without an image would predict the camera out of the room.
    if (settings_.constant_velocity && nothing_measured) damp(dt);
    if (filter_.variance(Body::kTheta) > kMaxRotationSigma * kMaxRotationSigma)
      noise.linear = noise.angular = Scalar(0);
  }
  Transition transition;
  if (settings_.constant_velocity) filter_.steer(data_.dv_C, data_.dw_C);
  predict(filter_.body(), dt, noise, &transition);
  filter_.predict(transition);
  data_ = Data();
}

void BodyMotion::predict(Body& body, Scalar dt, const MotionNoise& noise, Transition* transition) const {
  if (settings_.constant_velocity)
    predict_constant_velocity(body, dt, noise, transition);
  else
    predict_constant_position(body, dt, noise, transition);
}

/// Lets the speed decay while nothing is measured.
void BodyMotion::damp(Scalar dt) {
  Mat6 P_speed;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) P_speed(i, j) = filter_.covariance()(Body::kVelocity + i, Body::kVelocity + j);
  Transition transition;
  damp_speed(filter_.body(), std::exp(-dt / kSpeedDecay), P_speed, &transition);
  filter_.predict(transition);
}

void BodyMotion::predict_pose(std::int64_t now_ns, std::int64_t t_ns, Body* body, Mat6* covariance) const {
  *body = filter_.state().body;
  const int dim = filter_.state().body_dim;
  Scalar P[Body::kMaxDim * Body::kMaxDim];
  for (int i = 0; i < dim; ++i)
    for (int j = 0; j < dim; ++j) P[i * dim + j] = filter_.covariance()(i, j);
  if (t_ns > now_ns) {
    const Scalar dt = static_cast<Scalar>(static_cast<double>(elapsed_ns(now_ns, t_ns)) * 1e-9);
    Transition transition;
    predict(*body, dt, settings_.motion_noise, &transition);
    Scalar FP[Body::kMaxDim * Body::kMaxDim];
    for (int i = 0; i < dim; ++i)
      for (int j = 0; j < dim; ++j) {
        Scalar sum = 0;
        for (int k = 0; k < dim; ++k) sum += transition.F[i * dim + k] * P[k * dim + j];
        FP[i * dim + j] = sum;
      }
    for (int i = 0; i < dim; ++i)
      for (int j = 0; j < dim; ++j) {
        Scalar sum = transition.Q[i * dim + j];
        for (int k = 0; k < dim; ++k) sum += FP[i * dim + k] * transition.F[j * dim + k];
        P[i * dim + j] = sum;
      }
  }
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) (*covariance)(i, j) = P[i * dim + j];
}

}  // namespace pf
