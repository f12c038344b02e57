#pragma once

#include <cstdint>

#include "sim/imu.h"

namespace pfsim {

/// Rows of a phone's camera, of which its calibration says nothing [s].
inline constexpr double kPhoneReadout = 0.02;

/// Turns a unit's axes by one of the 24 rotations of a cube, 0 to 23, about its origin; that stays where it is on the camera.
void turn_axes(int which, pf::sim::ImuOptions* imu);

/// Makes a unit what phones have, beside what is told of it: scales off by 1 % and axes by 0.5 % (standard deviations, of each sensor and
/// axis), three times the noise, samples 50 ms early with stamps that jitter by 1 ms, mounted 2 degrees off.
void make_phone(std::uint64_t seed, pf::sim::ImuOptions* imu);

}  // namespace pfsim
