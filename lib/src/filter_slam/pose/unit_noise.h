#pragma once

#include <cstdint>

#include "filter/imu_log.h"
#include "filter/preintegral.h"
#include "frame/settings.h"

/// How noisy the inertial unit is: the stated densities are the prior, and two things correct them (lib/docs/theory/inertial.md, "Noise"):
///
/// - what its own samples scatter by: third differences of white noise have 20 times its variance, those of a hand's motion next to
///   none;
/// - innovations that P does not explain: errors of scale, of axes, of stamps. A likelihood ratio in the variance, by its gradient.
///
/// Of each density, both together stay between a third and ten times what was stated.

namespace pf {

class UnitNoise {
 public:
  enum Sensor { kGyro = 0, kAccel = 1 };

  UnitNoise(const Settings& settings, const ImuLog& imu) : settings_(settings), imu_(imu) { init(); }

  void init() { data_ = Data(); }
  /// Takes in the samples since the last call.
  void note_samples();
  /// nis: of a frame's innovation, the part that the sensor's noise should explain; dof: its degrees of freedom.
  void note_innovation(Sensor sensor, Scalar nis, int dof);

  /// Densities as they are known now.
  ImuNoise now() const;
  /// Of the density to the stated one.
  Scalar ratio(Sensor sensor) const;
  /// Innovations are not explained by noise of ten times what was stated either.
  bool is_at_bound(Sensor sensor) const;

 private:
  struct Data {
    std::int64_t last_ns = INT64_MIN;  ///< of the last sample that was taken in
    Scalar second[2] = {0, 0};         ///< sums of squared second and third differences over the axes
    Scalar third[2] = {0, 0};
    int count = 0;              ///< of them
    Scalar white[2] = {1, 1};   ///< variance of the samples to the stated one
    Scalar excess[2] = {0, 0};  ///< log of the factor on the variance, from innovations; never below 0
  };

  void close_window();

  const Settings& settings_;
  const ImuLog& imu_;
  Data data_;
};

}  // namespace pf
