#pragma once

#include <cstdint>

namespace pf {

/// Why the samples are not used, or not all of them; as pf_imu_reason_t says.
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
