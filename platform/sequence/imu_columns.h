#ifndef PLANEFOLD_PLATFORM_SEQUENCE_IMU_COLUMNS_H
#define PLANEFOLD_PLATFORM_SEQUENCE_IMU_COLUMNS_H

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "table.h"
#include "time_unit.h"

namespace pf::sequence {

/// Three columns of a table and what their numbers are to be multiplied by.
struct Axes {
  bool found = false;
  std::array<size_t, 3> column{};
  double factor = 1.0;  ///< to rad/s or m/s^2
};

/// Where a table of inertial samples has what.
struct ImuColumns {
  static constexpr size_t kNone = static_cast<size_t>(-1);

  size_t time = 0;
  size_t nanoseconds = kNone;  ///< beside whole seconds, as ROS writes them
  bool unit_said = false;      ///< the header names the unit of times
  TimeUnit unit = TimeUnit::kNanoseconds;
  Axes gyro, accel;
  Axes gravity;        ///< to be added to accel, which is without it
  size_t columns = 0;  ///< of each row
  std::string note;    ///< what was converted, and what is left out; "": nothing
};

/// What a file holds, where its name says so and its columns do not.
enum class ImuContent { kBoth, kGyro, kAccel, kGravity };

/// By the names in the header, with their units; without a header time, three rates, three accelerations. Of a file with one sensor:
/// time and three numbers, or the reverse. Throws ReadError where names or units are not known.
ImuColumns columns_of(const Table& table, ImuContent content);

}  // namespace pf::sequence

#endif
