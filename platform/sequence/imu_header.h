#ifndef PLANEFOLD_PLATFORM_SEQUENCE_IMU_HEADER_H
#define PLANEFOLD_PLATFORM_SEQUENCE_IMU_HEADER_H

#include <string>

namespace pf::sequence {

/// What a column holds, by its name.
enum class ImuRole {
  kOther,          ///< nothing that is used
  kTime,           ///< a time that was recorded with the sample
  kElapsed,        ///< a time for people: since the start, of the log
  kGyro,           ///< angular velocity
  kTotal,          ///< specific force, where one without gravity may lie beside it
  kAccel,          ///< specific force
  kAccelOrMotion,  ///< linear acceleration: ROS has gravity in it, phones have not
  kMotion,         ///< acceleration of the device, without gravity
  kGravity,        ///< what is missing there
  kPlain           ///< x, y or z of what the file is of
};

struct ImuColumn {
  ImuRole role = ImuRole::kOther;
  int axis = 0;         ///< 0 .. 2
  std::string family;   ///< the name without its axis: the same for three columns of one sensor
  std::string unit;     ///< as written, in small letters and without blanks; "": not said
  bool is_ios = false;  ///< of Core Motion, where gravity is -1 along the axis that points up
};

/// "accelerometerAccelerationX(G)", "w_RS_S_x [rad s^-1]", "gyro_z_dps", "Time (s)".
ImuColumn read_imu_column(const std::string& name);

/// To rad/s or m/s^2. 0: the unit is not known, or of something else.
double factor_of_rate(const std::string& unit);
double factor_of_acceleration(const std::string& unit);

constexpr double kStandardGravity = 9.80665;  ///< [m/s^2] one g of data sheets and phones

}  // namespace pf::sequence

#endif
