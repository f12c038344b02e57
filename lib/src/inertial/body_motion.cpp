#include "inertial/body_motion.h"

#include <algorithm>
#include <cmath>

#include "base/elapsed.h"
#include "filter/inertial_motion.h"
#include "frame/speed_limits.h"

namespace pf {
namespace {

/// After kMaxGapNs no motion is predictable, and the covariance grows no further.
Scalar predicted_seconds(std::int64_t before_ns, std::int64_t t_ns) {
  const std::int64_t gap_ns = elapsed_ns(before_ns, t_ns);
  return static_cast<Scalar>(seconds(gap_ns < BodyMotion::kMaxGapNs ? gap_ns : BodyMotion::kMaxGapNs));
}

/// Of three axes of the body.
Scalar largest_variance(const Filter& filter, int first_row) {
  return std::max({filter.variance(first_row), filter.variance(first_row + 1), filter.variance(first_row + 2)});
}

constexpr double kLeastSpan = 2;  ///< sample intervals, of which a difference of readings is taken

}  // namespace

std::int64_t BodyMotion::on_unit_clock(std::int64_t t_ns) const {
  std::int64_t shifted, delay_ns = settings_.unit.delay_ns;
  if (settings_.body.has(BodyPart::kDelay) &&
      __builtin_add_overflow(delay_ns, nanoseconds(static_cast<double>(filter_.state().mounting.delay)), &delay_ns))
    return t_ns;
  return __builtin_sub_overflow(t_ns, delay_ns, &shifted) ? t_ns : shifted;
}

void BodyMotion::advance(std::int64_t before_ns, std::int64_t t_ns, bool coasting_or_lost, bool nothing_measured) {
  MotionNoise noise = settings_.motion_noise;
  if (coasting_or_lost) {
    // The position keeps growing with the speed.
    if (has_rate() && nothing_measured) damp(predicted_seconds(before_ns, t_ns));
    noise = limited_noise();
  }
  Transition transition;
  if (settings_.constant_velocity && data_.given) {
    change_velocity(filter_.state().body, settings_.body, data_.dv_C, data_.dw_C, &transition);
    filter_.tell_gauge();  // a speed in metres
    filter_.predict(transition);
  }
  predict(filter_.state().body, before_ns, t_ns, noise, &transition);
  filter_.predict(transition);
  data_ = Data();
}

/// Whether the angular velocity is part of the state, which then moves by constant velocity.
bool BodyMotion::has_rate() const {
  return settings_.constant_velocity || (settings_.inertial && !filter_.uses_samples());
}

MotionNoise BodyMotion::limited_noise() const {
  const bool has_velocity = settings_.body.has(BodyPart::kVelocity);
  const int linear = has_velocity ? settings_.body.row(BodyPart::kVelocity) : Body::kPosition;
  return pf::limited_noise(settings_.motion_noise, has_velocity, largest_variance(filter_, Body::kTheta),
                           largest_variance(filter_, linear));
}

void BodyMotion::predict(const Body& body, std::int64_t before_ns, std::int64_t t_ns, const MotionNoise& noise,
                         Transition* transition) const {
  if (settings_.inertial)
    predict_by_samples(body, before_ns, t_ns, noise, transition);
  else
    predict_after(body, predicted_seconds(before_ns, t_ns), noise, transition);
}

void BodyMotion::predict_by_samples(const Body& body, std::int64_t before_ns, std::int64_t t_ns,
                                    const MotionNoise& noise, Transition* transition) const {
  const Mounting& mounting = filter_.state().mounting;
  if (!filter_.uses_samples()) {
    predict_without_samples(body, settings_.body, mounting, predicted_seconds(before_ns, t_ns), noise, transition);
    return;
  }
  Preintegral samples(noise_.now(), body.gyro_bias, body.accel_bias, mounting.intrinsics);
  ImuReading now;
  integrate_samples(imu_, on_unit_clock(before_ns), on_unit_clock(t_ns), coasting(body, noise), &samples, &now);
  predict_by(body, samples, noise, transition);
  transition->mean.w_C = mounting.rate_C(now.gyro - body.gyro_bias);
  transition->bend = bend_of_readout(on_unit_clock(t_ns), now, transition->mean);
}

void BodyMotion::begin(std::int64_t t_ns, Body* body) const {
  if (!settings_.inertial || !filter_.uses_samples() || imu_.held() == 0) return;
  const std::int64_t unit_ns = on_unit_clock(t_ns);
  ImuReading now;
  if (!reading_at(imu_, unit_ns, &now)) {  // the first sample of all, where the rows were read out about its time
    const ImuSample& last = imu_[imu_.held() - 1];
    const double half = std::abs(static_cast<double>(filter_.lens().readout)) / 2;
    if (imu_.held() > 1 || std::abs(seconds(elapsed_ns(last.t_ns, unit_ns))) > half) return;
    now.gyro = Vec3(last.gyro[0], last.gyro[1], last.gyro[2]);
  }
  body->w_C = filter_.state().mounting.rate_C(now.gyro - body->gyro_bias);
}

/// How the camera accelerates while the frame's rows are read out, as it did in the half of that time before the frame's:
///
///   alpha = R_CB D_w (gyro - gyro_before) / T,   a = R_CB D_a (accel - b_a) + R_CW g_W - alpha x m - w x (w x m)
Bend BodyMotion::bend_of_readout(std::int64_t unit_ns, const ImuReading& now, const Body& body) const {
  Bend bend;
  const double readout = static_cast<double>(filter_.lens().readout), interval = seconds(imu_.counts().median_ns);
  if (readout == 0) return bend;
  const double T = std::max(std::abs(readout) / 2, kLeastSpan * interval);
  ImuReading before;
  std::int64_t before_ns;
  if (__builtin_sub_overflow(unit_ns, nanoseconds(T), &before_ns) || !reading_at(imu_, before_ns, &before)) return bend;
  const Mounting& mounting = filter_.state().mounting;
  bend.alpha_C = mounting.rate_C((now.gyro - before.gyro) / static_cast<Scalar>(T));
  if (!filter_.is_metric()) return bend;
  const Vec3 &w = body.w_C, &m = mounting.p_C, accel = (now.accel + before.accel) / 2 - body.accel_bias;
  bend.a_C = mounting.R_CB * (mounting.intrinsics.D_a * accel) +
             body.q_WC.conjugate() * (settings_.unit.gravity * body.gravity_W()) - bend.alpha_C.cross(m) -
             w.cross(w.cross(m));
  return bend;
}

void BodyMotion::predict_coasting(const Body& body, std::int64_t before_ns, std::int64_t t_ns,
                                  Transition* transition) const {
  const Coasting c = coasting(body, settings_.motion_noise);
  Preintegral path(noise_.now(), body.gyro_bias, body.accel_bias, filter_.state().mounting.intrinsics);
  path.coast(predicted_seconds(before_ns, t_ns), c.w_B, c.f_B, c.noise.angular, c.noise.linear);
  predict_by(body, path, c.noise, transition);
}

Coasting BodyMotion::coasting(const Body& body, const MotionNoise& noise) const {
  const Mat3& R_CB = filter_.state().mounting.R_CB;
  const Quat q_BW = Quat(Mat3(body.q_WC.toRotationMatrix() * R_CB)).conjugate();
  return {R_CB.transpose() * body.w_C, q_BW * (-settings_.unit.gravity * body.gravity_W()), noise};
}

void BodyMotion::predict_by(const Body& body, const Preintegral& samples, const MotionNoise& noise,
                            Transition* transition) const {
  const Mounting& mounting = filter_.state().mounting;
  if (filter_.is_metric())
    predict_inertial(body, settings_.body, mounting, samples, settings_.unit.gravity, transition);
  else
    predict_rotation_only(body, settings_.body, mounting, samples, noise.linear, transition);
}

/// Prediction by a model without samples, dt [s] later.
void BodyMotion::predict_after(const Body& body, Scalar dt, const MotionNoise& noise, Transition* transition) const {
  if (settings_.body.has(BodyPart::kAcceleration))
    predict_constant_acceleration(body, settings_.body, dt, noise, transition);
  else if (settings_.constant_velocity)
    predict_constant_velocity(body, settings_.body, dt, noise, transition);
  else
    predict_constant_position(body, settings_.body, dt, noise, transition);
}

/// Lets the speed decay while nothing is measured, and what accelerates it.
void BodyMotion::damp(Scalar dt) {
  Mat6 P_speed;
  const int first = settings_.body.row(BodyPart::kVelocity);  // the angular velocity follows
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) P_speed(i, j) = filter_.covariance()(first + i, first + j);
  const Body& body = filter_.state().body;
  Vec3 rate = settings_.inertial ? Vec3(-filter_.state().mounting.reading_of(body.w_C)) : body.w_C;  // e_b = -e_w
  limit_speed(dt, largest_variance(filter_, Body::kTheta), largest_variance(filter_, Body::kPosition), &rate, &P_speed);
  Transition transition;
  damp_speed(body, settings_.body, speed_decay(dt), rate, P_speed, &transition);
  filter_.predict(transition);
  if (!settings_.body.has(BodyPart::kAcceleration)) return;
  const Scalar sigma = limited_noise().linear > Scalar(0) ? tuning::body_motion::kAcceleration : Scalar(0);
  damp_acceleration(filter_.state().body, settings_.body, speed_decay(dt), sigma, &transition);
  filter_.predict(transition);
}

/// With B the rows of the pose by the errors c of the intrinsics:   B P_cb F^T + F P_bc B^T + B P_cc B^T
Mat6 BodyMotion::covariance_by_intrinsics(const Transition& transition) const {
  constexpr int kColumns = Intrinsics::kRows;
  const int first = settings_.body.row(BodyPart::kIntrinsics), dim = transition.dim;
  const Triangle& P = filter_.covariance();
  Eigen::Matrix<Scalar, 6, kColumns> half;  // F P_bc + B P_cc / 2
  for (int i = 0; i < 6; ++i)
    for (int c = 0; c < kColumns; ++c) {
      Scalar sum = 0;
      for (int k = 0; k < dim; ++k) sum += transition.F[i * dim + k] * P(first + c, k);
      for (int k = 0; k < kColumns; ++k)
        sum += transition.by_intrinsics[i * kColumns + k] * P(first + c, first + k) / 2;
      half(i, c) = sum;
    }
  Mat6 out = Mat6::Zero();
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j)
      for (int c = 0; c < kColumns; ++c)
        out(i, j) += half(i, c) * transition.by_intrinsics[j * kColumns + c] +
                     half(j, c) * transition.by_intrinsics[i * kColumns + c];
  return out;
}

void BodyMotion::predict_pose(std::int64_t now_ns, std::int64_t t_ns, Body* body, Mat6* covariance) const {
  *body = filter_.state().body;
  Mat6 by_unit = Mat6::Zero();
  const int dim = settings_.body.dynamic_rows();
  Scalar P[BodyLayout::kMaxDynamicRows * BodyLayout::kMaxDynamicRows];
  filter_.body_covariance(dim, P);
  if (t_ns > now_ns) {
    Transition transition;
    if (settings_.inertial)
      predict_by_samples(*body, now_ns, t_ns, settings_.motion_noise, &transition);
    else
      predict_after(*body, static_cast<Scalar>(seconds(elapsed_ns(now_ns, t_ns))), settings_.motion_noise, &transition);
    *body = transition.mean;
    if (transition.has_intrinsics) by_unit = covariance_by_intrinsics(transition);
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
    for (int j = 0; j < 6; ++j) (*covariance)(i, j) = P[i * dim + j] + by_unit(i, j);
}

}  // namespace pf
