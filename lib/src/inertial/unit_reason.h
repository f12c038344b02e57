#pragma once

#include <cstdint>

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

}  // namespace pf
