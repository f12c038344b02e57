#include "inertial/moving_start.h"

#include <algorithm>
#include <cmath>

#include "base/elapsed.h"
#include "geometry/so3.h"
#include "inertial/tuning.h"

namespace pf {

using namespace tuning::moving_verdict;

namespace {

constexpr int kSignEvery = 4;  ///< solutions in a row that there are none of, from test to test of the sign

}  // namespace

/// Smooths the rotations of the views by pixels and gyroscope together. Returns the gyroscope's bias.
Vec3 MovingStart::smooth() {
  const Mat3& R_CB = filter_.state().mounting.R_CB;
  const Quat q_CB(R_CB);
  const Vec3 gyro_bias = filter_.state().body.gyro_bias;
  const Scalar of_turn = turn_variance() + scale_variance(), of_delay = delay_variance();
  Vec3 rate = Vec3::Zero();
  const Scalar density = std::max(kTiltDensity, motion_.unit_noise().now().gyro_density);
  for (int k = data_.first; k < data_.end; ++k) {
    const View& view = data_.view[k];
    RotationLink& link = data_.link[k];
    const Mat3 by_bias = view.samples.by_bias.topLeftCorner<3, 3>().cast<Scalar>();
    const Quat dq_B = exp_so3(Vec3(by_bias * (gyro_bias - view.samples.gyro_bias))) * view.samples.dq_B;
    link.q_WC = view.q_WC;
    link.variance = data_.correlation * static_cast<Scalar>(view.covariance.topLeftCorner<3, 3>().trace()) / 3;
    link.dq = q_CB * dq_B * q_CB.conjugate();
    // An error mu of the axes rotates the step by mu x step, an error e of the scale lengthens it by e, and an error e of the delay moves
    // both ends: (w_0 - w_1) e.
    const Vec3 step = log_so3(dq_B), rate_before = rate;
    if (view.samples.dt > Scalar(0)) rate = step / view.samples.dt;
    link.step_variance = density * density * view.samples.dt + of_turn * step.squaredNorm() +
                         (k > data_.first + 1 ? of_delay * (rate - rate_before).squaredNorm() : Scalar(0));
    link.by_bias = R_CB * dq_B.conjugate().toRotationMatrix() * by_bias;
  }
  const Scalar of_bias = mean_variance(settings_.body.row(BodyPart::kGyroBias));
  return gyro_bias + smooth_rotations(data_.link + data_.first, data_.end - data_.first, of_bias);
}

/// The poses of the sweep: positions given the smoothed rotations, e | theta = S_et S_tt^-1 theta. Returns how many.
int MovingStart::collect() {
  const Mat3& R_CB = filter_.state().mounting.R_CB;
  const Vec3 gyro_bias = smooth();
  const int count = data_.end - data_.first;
  for (int k = 0; k < count; ++k) {
    const View& view = data_.view[data_.first + k];
    const RotationLink& link = data_.link[data_.first + k];
    MovingPose& pose = data_.pose[k];
    const Mat6 S = data_.correlation * view.covariance.cast<Scalar>();
    const Mat3 of_rotation = S.topLeftCorner<3, 3>();
    const Mat3 by_rotation = S.bottomLeftCorner<3, 3>() * of_rotation.inverse();
    const Mat3 given = S.bottomRightCorner<3, 3>() - by_rotation * S.topRightCorner<3, 3>();
    pose.p_W = view.p_W + by_rotation * log_so3(link.q_WC * view.q_WC.conjugate());
    pose.sigma = std::sqrt((given.trace() + link.variance * by_rotation.squaredNorm()) / 3);
    pose.m_W = link.q_WC * settings_.unit.mounting.p_C;
    if (k == 0) continue;
    const Mat3 R_WB = data_.link[data_.first + k - 1].q_WC.toRotationMatrix() * R_CB;
    const Eigen::Matrix<Scalar, 9, 6> by_bias = view.samples.by_bias.cast<Scalar>();
    const Vec3 more = gyro_bias - view.samples.gyro_bias;
    pose.dt = view.samples.dt;
    pose.Rv = R_WB * (view.samples.v + by_bias.block<3, 3>(3, 0) * more);
    pose.Rp = R_WB * (view.samples.p + by_bias.block<3, 3>(6, 0) * more);
    pose.Rv_b = R_WB * by_bias.block<3, 3>(3, 3);
    pose.Rp_b = R_WB * by_bias.block<3, 3>(6, 3);
  }
  return count;
}

/// What a rest tells of the first pose, which is one of it. Its bias walks on until the poses' middle.
MovingRest MovingStart::rest_of_first(Scalar depth, Scalar span) const {
  const RestReading& reading = rest_.reading;
  const RotationLink& link = data_.link[data_.first];
  const Mat3 R_WB = link.q_WC.toRotationMatrix() * filter_.state().mounting.R_CB;
  const Mat3& D_a = filter_.state().mounting.intrinsics.D_a;
  const Scalar walk = motion_.unit_noise().now().accel_walk;
  MovingRest rest;
  rest.f_W = R_WB * (D_a * reading.accel);
  rest.f_b = -(R_WB * D_a);
  rest.sigma_force = std::sqrt(reading.sigma_accel * reading.sigma_accel +
                               reading.gravity * reading.gravity * link.variance + walk * walk * span / 2);
  rest.sigma_speed = reading.sigma_speed * depth / settings_.start_depth;
  return rest;
}

/// Whether the opposite accelerations would explain the motion.
void MovingStart::look_for_sign(int count, const MovingStartNoise& noise) {
  const auto reverse = [&] {
    for (int k = 0; k < count; ++k)
      for (Vec3* of : {&data_.pose[k].Rv, &data_.pose[k].Rp}) *of = -*of;
  };
  MovingSolution solution;
  MovingStartNoise without_rest = noise;
  without_rest.rest = nullptr;
  reverse();
  data_.reversed = solve_moving_start(data_.pose, count, without_rest, &solution) &&
                   solution.sigma_scale() < kLateSigmaScale && solution.misfit < kMaxMisfit;
  reverse();
}

bool MovingStart::is_accepted(const MovingPose* pose, int count, const MovingStartNoise& noise, bool patient,
                              MovingSolution* solution) {
  MovingSolution half[2];
  const int middle = count / 2;
  MovingStartNoise of_second = noise;
  of_second.rest = nullptr;
  data_.sigma_scale = 0;
  if (!solve_moving_start(pose, count, noise, solution)) {
    if (++data_.refused % kSignEvery == 0) look_for_sign(count, noise);
    return false;
  }
  data_.refused = 0;
  data_.reversed = false;
  data_.sigma_scale = solution->sigma_scale();
  if (!(solution->sigma_scale_by_motion() < (patient ? kMaxSigmaScale : kLateSigmaScale)) ||
      !(solution->sigma_gravity_by_motion() < (patient ? kMaxSigmaGravity : kLateSigmaGravity)))
    return false;
  if (!(solution->misfit < kMaxMisfit)) return false;
  if (!solve_moving_start(pose, middle + 1, noise, &half[0]) ||
      !solve_moving_start(pose + middle, count - middle, of_second, &half[1]))
    return false;
  const Scalar of_scale = half[0].covariance(0, 0) + half[1].covariance(0, 0);
  const Scalar of_gravity =
      half[0].sigma_gravity() * half[0].sigma_gravity() + half[1].sigma_gravity() * half[1].sigma_gravity();
  const Scalar apart = std::log(half[0].scale / half[1].scale);
  const Vec3 g_0 = half[0].q_WG.toRotationMatrix().col(2), g_1 = half[1].q_WG.toRotationMatrix().col(2);
  return apart * apart < kMaxApart * of_scale && (g_0 - g_1).squaredNorm() < kMaxApart * of_gravity;
}

/// Of the filter's rows from `row` on, three of them.
Scalar MovingStart::mean_variance(int row) const {
  return (filter_.variance(row) + filter_.variance(row + 1) + filter_.variance(row + 2)) / 3;
}

/// Of the unit's axes, about one of them, and of its delay; 0 where they are exact.
Scalar MovingStart::turn_variance() const {
  return settings_.body.has(BodyPart::kMountRotation) ? mean_variance(settings_.body.row(BodyPart::kMountRotation))
                                                      : Scalar(0);
}

/// Of the gyroscope's intrinsics, a mean over those on the diagonal.
Scalar MovingStart::scale_variance() const {
  return settings_.body.has(BodyPart::kIntrinsics) ? mean_variance(settings_.body.row(BodyPart::kIntrinsics))
                                                   : Scalar(0);
}

/// Of the accelerometer's, all of it.
MovingStartNoise::OfForce MovingStart::force_covariance() const {
  MovingStartNoise::OfForce C;
  const int first = settings_.body.row(BodyPart::kIntrinsics) + Intrinsics::kGyroRows;
  for (int i = 0; i < Intrinsics::kAccelRows; ++i)
    for (int j = 0; j < Intrinsics::kAccelRows; ++j)
      C(i, j) = filter_.covariance()(first + std::max(i, j), first + std::min(i, j));
  return C;
}

Scalar MovingStart::delay_variance() const {
  return settings_.body.has(BodyPart::kDelay) ? filter_.variance(settings_.body.row(BodyPart::kDelay)) : Scalar(0);
}

/// Of the unit's rate over the sweep's views, squared.
Scalar MovingStart::mean_rate2() const {
  Scalar sum = 0, time = 0;
  for (int k = data_.first + 1; k < data_.end; ++k) {
    const View& view = data_.view[k];
    sum += log_so3(view.samples.dq_B).squaredNorm() / view.samples.dt;
    time += view.samples.dt;
  }
  return time > Scalar(0) ? sum / time : Scalar(0);
}

/// Sigma of the rate at which the poses' rotations drift from the truth: by the map, which drifts with them, or by the gyroscope.
Scalar MovingStart::turn_rate_sigma(Scalar span) const {
  const Scalar by_map = mean_variance(Body::kTheta) / (span * span);
  return std::sqrt(std::min(by_map, mean_variance(settings_.body.row(BodyPart::kGyroBias))));
}

bool MovingStart::note(const MovingFrame& told, const MovingPoints& points, MovingSolution* solution) {
  if (!told.keep || told.map_id != data_.map_id) init();
  data_.map_id = told.map_id;
  ++data_.frames;
  const double interval = static_cast<double>(kInterval) * (1 << rest_.halvings);
  if (!told.keep || (data_.count > 0 && seconds(elapsed_ns(data_.t_ns, frame_.report.t_ns)) < interval)) return false;
  data_.correlation = std::max(Scalar(1), told.correlation / static_cast<Scalar>(data_.frames));
  if (!add(told, points)) {
    init();
    return false;
  }
  const Scalar delay_sigma = std::sqrt(delay_variance());
  if (data_.count == 1) data_.delay_sigma = delay_sigma;
  if (told.judge && kBetterDelay * delay_sigma < data_.delay_sigma) {
    data_.delay_sigma = delay_sigma;
    integrate_again();
  }
  if (!told.judge || data_.count < kMinPoses || !sweep(points)) return false;
  Scalar span = 0;
  for (int k = data_.first + 1; k < data_.end; ++k) span += data_.view[k].samples.dt;
  if (data_.end - data_.first < kMinPoses || span < kMinSpan) return false;
  MovingStartNoise noise;
  noise.gravity = settings_.unit.gravity;
  noise.drift = kDrift * told.depth;
  noise.accel_density = std::hypot(motion_.unit_noise().now().accel_density, settings_.unit.gravity * kRotation);
  noise.tilt_density = std::max(kTiltDensity, motion_.unit_noise().now().gyro_density);
  // An error mu of the axes tilts gravity by mu w a second as the camera rotates, an error e of the delay by e w.
  const Scalar of_unit = (turn_variance() + scale_variance() + 2 * delay_variance()) * mean_rate2();
  noise.tilt_density = std::sqrt(noise.tilt_density * noise.tilt_density + of_unit);
  noise.turn = turn_rate_sigma(span);
  noise.accel_bias = tuning::inertial::kAccelBias;
  MovingStartNoise::OfForce of_force;
  if (settings_.body.has(BodyPart::kIntrinsics)) {
    of_force = force_covariance();
    noise.of_force = &of_force;
  }
  const int count = collect();
  MovingRest rest;
  if (rest_.is_first && data_.first == 0) {
    rest = rest_of_first(told.depth, span);
    noise.rest = &rest;
  }
  return is_accepted(data_.pose, count, noise, told.patient, solution);
}

}  // namespace pf
