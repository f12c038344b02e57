#pragma once

#include <array>
#include <cstdint>

#include "planefold/planefold.h"
#include "sim/trajectory.h"

namespace pf::sim {

/// A simulated inertial unit: how it is mounted, and what is wrong with it.
struct ImuOptions {
  double rate_hz = 200;
  double gyro_density = 1.7e-4, accel_density = 2e-3;  ///< [rad/s/sqrt(Hz)], [m/s^2/sqrt(Hz)]
  double gyro_walk = 2e-5, accel_walk = 3e-3;          ///< [rad/s^2/sqrt(Hz)], [m/s^3/sqrt(Hz)]
  Vec3 gyro_bias, accel_bias;                          ///< at time 0 [rad/s], [m/s^2]
  Mat3 R_BC;                                           ///< p_B = R_BC p_C + p_BC
  Vec3 p_BC;                                           ///< [m]
  Vec3 gravity_W{0, 9.81, 0};                          ///< [m/s^2]
  double delay_s = 0;  ///< a sample's own time stamp is so much before the frames' clock
  std::uint64_t seed = 1;

  // What is wrong with it.
  double gyro_scale = 0, accel_scale = 0;  ///< relative errors of scale
  /// Errors of scale and of the directions of the axes: a reading is (1 + E) times the truth.
  std::array<double, 9> gyro_error{}, accel_error{};  ///< E, row-major
  double gyro_range = 0, accel_range = 0;             ///< [rad/s], [m/s^2] at which readings end; 0: nowhere
  double jitter_s = 0;             ///< standard deviation of time stamps, at most a quarter of the interval [s]
  double gap_at_s = 0, gap_s = 0;  ///< no samples from here on for this long [s]
};

/// Samples of a unit that is carried along a camera's path, from its derivatives: one after the other, with white noise of
/// density x sqrt(rate) and biases that walk. The draws hang on the seed and on nothing else.
class ImuSensor {
 public:
  ImuSensor(const ImuOptions& options, Trajectory path);

  /// Time of the next sample on the clock of the frames [ns].
  std::int64_t next_ns() const;
  pf_imu_sample_t next();
  /// Biases of the sample that came last.
  const Vec3& gyro_bias() const { return gyro_bias_; }
  const Vec3& accel_bias() const { return accel_bias_; }

 private:
  double time_of(std::int64_t count) const { return static_cast<double>(count) / options_.rate_hz; }
  bool in_gap(std::int64_t count) const;
  void walk();

  ImuOptions options_;
  Trajectory path_;
  Random noise_, walk_, stamps_;
  Vec3 gyro_bias_, accel_bias_;
  std::int64_t count_ = 0, walked_ = 0;  ///< the next sample, and that of the biases
};

/// What a unit without noise and biases measures at a time: angular velocity and specific force in its axes.
void true_reading(const ImuOptions& options, const Trajectory& path, double t, Vec3& gyro, Vec3& accel);

/// The same path behind a rest: it stands still at its beginning for rest_s, then gets to its own speed over ramp_s.
Trajectory after_rest(Trajectory base, double rest_s, double ramp_s);

}  // namespace pf::sim
