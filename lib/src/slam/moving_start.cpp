#include "slam/moving_start.h"

#include <algorithm>
#include <cmath>

#include "base/elapsed.h"
#include "filter/imu_path.h"
#include "slam/tuning.h"

namespace pf {

using namespace tuning::moving_verdict;

/// Integrates the samples since the last pose, and keeps this one. False where samples are missing.
bool MovingStart::add(std::int64_t t_ns) {
  const State& state = filter_.state();
  const Mat3 R_WC = state.body.q_WC.toRotationMatrix();
  MovingPose pose;
  pose.p_W = state.body.p_W;
  pose.m_W = R_WC * settings_.unit.mounting.p_C;
  if (data_.count > 0) {
    Preintegral samples(settings_.unit.noise, state.body.gyro_bias, Vec3::Zero());
    ImuReading now;
    if (integrate_samples(imu_, motion_.on_unit_clock(data_.t_ns), motion_.on_unit_clock(t_ns), Coasting(), &samples,
                          &now) > Scalar(0))
      return false;
    pose.dt = samples.dt();
    pose.Rv = data_.R_WB * samples.v();
    pose.Rp = data_.R_WB * samples.p();
    pose.Rv_b = data_.R_WB * samples.by_bias().block<3, 3>(3, 3);
    pose.Rp_b = data_.R_WB * samples.by_bias().block<3, 3>(6, 3);
  }
  if (data_.count == kMaxMovingPoses) std::copy(data_.pose + 1, data_.pose + data_.count--, data_.pose);
  data_.pose[data_.count++] = pose;
  data_.t_ns = t_ns;
  data_.R_WB = R_WC * state.mounting.R_CB;
  return true;
}

bool MovingStart::is_accepted(const MovingStartNoise& noise, MovingSolution* solution) const {
  MovingSolution half[2];
  const int count = data_.count, middle = count / 2;
  if (!solve_moving_start(data_.pose, count, noise, solution)) return false;
  if (!(solution->sigma_scale() < kMaxSigmaScale) || !(solution->sigma_gravity() < kMaxSigmaGravity)) return false;
  if (!(solution->misfit < kMaxMisfit)) return false;
  if (!solve_moving_start(data_.pose, middle + 1, noise, &half[0]) ||
      !solve_moving_start(data_.pose + middle, count - middle, noise, &half[1]))
    return false;
  const Scalar of_scale = half[0].covariance(0, 0) + half[1].covariance(0, 0);
  const Scalar of_gravity =
      half[0].sigma_gravity() * half[0].sigma_gravity() + half[1].sigma_gravity() * half[1].sigma_gravity();
  const Scalar apart = std::log(half[0].scale / half[1].scale);
  const Vec3 g_0 = half[0].q_WG.toRotationMatrix().col(2), g_1 = half[1].q_WG.toRotationMatrix().col(2);
  return apart * apart < kMaxApart * of_scale && (g_0 - g_1).squaredNorm() < kMaxApart * of_gravity;
}

bool MovingStart::note(bool usable, std::int64_t t_ns, std::uint32_t map_id, Scalar depth, MovingSolution* solution) {
  if (!usable || map_id != data_.map_id) data_.count = 0;
  data_.map_id = map_id;
  if (!usable) return false;
  if (data_.count > 0 && elapsed_ns(data_.t_ns, t_ns) < kIntervalNs) return false;
  if (!add(t_ns)) {
    data_.count = 0;
    return false;
  }
  if (data_.count < kMinPoses) return false;
  MovingStartNoise noise;
  noise.gravity = settings_.unit.gravity;
  noise.position = kPosition * depth;
  noise.accel_density = settings_.unit.noise.accel_density;
  noise.tilt_density = std::max(kTiltDensity, settings_.unit.noise.gyro_density);
  noise.accel_bias = tuning::inertial::kAccelBias;
  return is_accepted(noise, solution);
}

}  // namespace pf
