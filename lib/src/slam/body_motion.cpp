#include "slam/body_motion.h"

#include <cmath>

#include "base/elapsed.h"
#include "slam/tuning.h"

namespace pf {
namespace {

using namespace tuning::body_motion;

}  // namespace
void BodyMotion::advance(std::int64_t gap_ns, bool coasting_or_lost, bool nothing_measured) {
  // After kMaxGapNs no motion is predictable, and the covariance grows no further.
  const Scalar dt = static_cast<Scalar>(seconds(gap_ns < kMaxGapNs ? gap_ns : kMaxGapNs));
  MotionNoise noise = settings_.motion_noise;
  if (coasting_or_lost) {
    // A hand does not keep its speed for long, and half a radian of rotation uncertainty already means searching everywhere. Without
    // these limits, one second without an image would predict the camera out of the room. The position keeps growing with the speed.
    if (settings_.constant_velocity && nothing_measured) damp(dt);
    if (filter_.variance(Body::kTheta) > kMaxRotationSigma * kMaxRotationSigma) noise.angular = Scalar(0);
    const int linear = settings_.constant_velocity ? settings_.body.row(BodyPart::kVelocity) : Body::kPosition;
    const Scalar most = settings_.constant_velocity ? kMaxSpeedSigma : kAnyPosition;
    if (filter_.variance(linear) > most * most) noise.linear = Scalar(0);
  }
  Transition transition;
  if (settings_.constant_velocity && data_.given) {
    change_velocity(filter_.state().body, settings_.body, data_.dv_C, data_.dw_C, &transition);
    filter_.predict(transition);
  }
  predict(filter_.state().body, dt, noise, &transition);
  filter_.predict(transition);
  data_ = Data();
}

void BodyMotion::predict(const Body& body, Scalar dt, const MotionNoise& noise, Transition* transition) const {
  if (settings_.constant_velocity)
    predict_constant_velocity(body, settings_.body, dt, noise, transition);
  else
    predict_constant_position(body, settings_.body, dt, noise, transition);
}

/// Lets the speed decay while nothing is measured.
void BodyMotion::damp(Scalar dt) {
  Mat6 P_speed;
  const int first = settings_.body.row(BodyPart::kVelocity);  // the angular velocity follows
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) P_speed(i, j) = filter_.covariance()(first + i, first + j);
  // Beyond any position and any rotation the speeds decay without noise that keeps them up.
  const bool any_rotation = filter_.variance(Body::kTheta) > kAnyRotation * kAnyRotation;
  const bool any_position = filter_.variance(Body::kPosition) > kAnyPosition * kAnyPosition;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j)
      if ((any_position && (i < 3 || j < 3)) || (any_rotation && (i >= 3 || j >= 3))) P_speed(i, j) = Scalar(0);
  Transition transition;
  damp_speed(filter_.state().body, settings_.body, std::exp(-dt / kSpeedDecay), P_speed, &transition);
  filter_.predict(transition);
}

void BodyMotion::predict_pose(std::int64_t now_ns, std::int64_t t_ns, Body* body, Mat6* covariance) const {
  *body = filter_.state().body;
  const int dim = settings_.body.dynamic_rows();
  Scalar P[BodyLayout::kMaxDynamicRows * BodyLayout::kMaxDynamicRows];
  for (int i = 0; i < dim; ++i)
    for (int j = 0; j < dim; ++j) P[i * dim + j] = filter_.covariance()(i, j);
  if (t_ns > now_ns) {
    const Scalar dt = static_cast<Scalar>(seconds(elapsed_ns(now_ns, t_ns)));
    Transition transition;
    predict(*body, dt, settings_.motion_noise, &transition);
    *body = transition.mean;
    Scalar FP[BodyLayout::kMaxDynamicRows * BodyLayout::kMaxDynamicRows];
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
