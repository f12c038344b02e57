#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sim/imu.h"

namespace pfsim {

/// Rows of a phone's camera, of which its calibration says nothing [s].
inline constexpr double kPhoneReadout = 0.02;

/// Turns a unit's axes by one of the 24 rotations of a cube, 0 to 23, about its origin; that stays where it is on the camera.
void turn_axes(int which, pf::sim::ImuOptions* imu);

/// What is wrong with a phone's unit and camera, all of it or some.
struct PhoneParts {
  bool scale = true;   ///< scales off by 1 % (standard deviation, of each sensor and axis)
  bool cross = true;   ///< directions of the sensors' axes off by 0.5 %, likewise
  bool noise = true;   ///< three times the noise
  bool delay = true;   ///< samples are 50 ms early
  bool jitter = true;  ///< their stamps jitter by 1 ms
  bool mount = true;   ///< mounted 2 degrees off
  bool rows = true;    ///< rows are read out over kPhoneReadout
};

/// Takes the parts that a list names, and leaves the others away; empty: all. Returns the first word that names none; "": all do.
std::string choose_parts(const std::vector<std::string>& names, PhoneParts* parts);

/// Makes a unit what phones have, beside what is told of it. What is drawn does not hang on the other parts.
void make_phone(std::uint64_t seed, const PhoneParts& parts, pf::sim::ImuOptions* imu);

}  // namespace pfsim
