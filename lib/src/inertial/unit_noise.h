#pragma once

#include <cstdint>

#include "filter/imu_log.h"
#include "filter/preintegral.h"
#include "frame/settings.h"

/// Noise densities of the inertial unit. The stated ones are the prior, and two estimates correct them (lib/docs/theory/inertial.md,
/// "Noise"):
///
/// - the scatter of its samples: third differences of white noise have 20 times its variance, those of a hand's motion next to
///   none;
/// - innovations that P does not explain: errors of scale, of axes, of stamps. A likelihood ratio in the variance, by its gradient.
///
/// Both together keep each density between a third and ten times the stated one.

namespace pf {

class Archive;

class UnitNoise {
 public:
  enum Sensor { kGyro = 0, kAccel = 1 };

  UnitNoise(const Settings& settings, const ImuLog& imu) : settings_(settings), imu_(imu) { init(); }

  void init() { data_ = Data(); }
  /// Adds the samples since the last call.
  void note_samples();
  /// Adds a frame's innovation. nis: the part that the sensor's noise should explain; dof: its degrees of freedom.
  void note_innovation(Sensor sensor, Scalar nis, int dof);

  /// Present densities.
  ImuNoise now() const;
  /// Ratio of the density to the stated one.
  Scalar ratio(Sensor sensor) const;
  /// True where not even ten times the stated noise explains the innovations.
  bool is_at_bound(Sensor sensor) const;

  void carry(Archive& archive);  ///< base/archive.h

 private:
  struct Data {
    std::int64_t last_ns = INT64_MIN;  ///< of the last sample that was added
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
