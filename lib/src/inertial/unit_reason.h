#pragma once

#include <cstdint>

#include "base/eigen.h"

namespace pf {

/// Why the samples are not used, or not all of them; the same numbers as pf_imu_reason_t.
enum class UnitReason : std::uint8_t {
  kNone,
  kWaitsForRotation,
  kWaitsForMotion,
  kContradicts,
  kGyroInDegrees,
  kGyroScale,
  kAxes,
  kLeftHanded,
  kClock,
  kRatesDoNotFit,
  kColumnsSwapped,
  kAccelInG,
  kAccelWithoutGravity,
  kAccelUnit,
  kAccelSign
};

class ForceCheck;
class MovingStart;
class UnitWatch;

/// What the reason depends on beside the checks: the map in which the unit moves.
struct UnitsMap {
  bool is_metric = false;  ///< lengths are metres by the unit
  bool has_pose = false;   ///< in a map: without one nothing is waited for
};

/// Why the samples do not move the body, or why lengths are not metres: what is wrong with the unit before what is missing, and of that the
/// gyroscope before the accelerometer. *value, *R_CB: the numbers that belong to the reason, where it has any.
UnitReason reason_of(const UnitWatch& watch, const ForceCheck& forces, const MovingStart& moving, UnitsMap map,
                     Scalar* value, Mat3* R_CB);

}  // namespace pf
