#include "imu_reason.h"

#include <array>
#include <cmath>
#include <cstdio>

namespace pf::capture {

namespace {

constexpr double kDegrees = 180.0 / 3.14159265358979;
constexpr double kWorthSaying = 5.0;  ///< [degrees]

constexpr std::array<const char*, 15> kNames = {"none",
                                                "waits-for-rotation",
                                                "waits-for-motion",
                                                "contradicts",
                                                "gyro-in-degrees",
                                                "gyro-scale",
                                                "axes",
                                                "left-handed",
                                                "clock",
                                                "rates-do-not-fit",
                                                "columns-swapped",
                                                "accel-in-g",
                                                "accel-without-gravity",
                                                "accel-unit",
                                                "accel-sign"};

std::string filled(const char* format, double value) {
  char text[400];
  std::snprintf(text, sizeof(text), format, value);
  return text;
}

}  // namespace

const char* reason_name(int32_t reason) {
  return reason >= 0 && static_cast<size_t>(reason) < kNames.size() ? kNames[static_cast<size_t>(reason)] : "none";
}

std::string axes_in_words(const double q[4]) {
  const double w = q[0], x = q[1], y = q[2], z = q[3];
  const double R_BC[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                             {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                             {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
  std::string text;
  double trace = 0.0;
  for (int i = 0; i < 3; ++i) {
    int best = 0;
    for (int j = 1; j < 3; ++j) {
      best = std::fabs(R_BC[i][j]) > std::fabs(R_BC[i][best]) ? j : best;
    }
    trace += std::fabs(R_BC[i][best]);
    text += std::string(i == 0 ? "its " : ", its ") + "xyz"[i] + (i == 0 ? " is the camera's " : " the camera's ") +
            (R_BC[i][best] < 0.0 ? "-" : "") + "xyz"[best];
  }
  const double off = kDegrees * std::acos(std::fmin(1.0, (trace - 1.0) / 2.0));
  return off > kWorthSaying ? text + filled(", within %.0f degrees", off) : text;
}

std::string reason_in_words(const pf_imu_report_t& report) {
  const double value = report.reason_value;
  switch (report.reason) {
    case PF_IMU_REASON_WAITS_FOR_ROTATION:
      return "its clock or its axes are not known yet; rotate the camera";
    case PF_IMU_REASON_WAITS_FOR_MOTION:
      return value > 0.0
                 ? filled("the scale is not known yet: so far within %.0f %%; move faster, to and fro", 100.0 * value)
                 : "the scale is not known yet; rest for a second, or move to and fro";
    case PF_IMU_REASON_CONTRADICTS:
      return "its samples contradict the pictures by more than noise of ten times the stated explains; check "
             "--imu-mount, "
             "the axes and signs (at rest the accelerometer shows +9.81 m/s^2 upwards), units and --imu-offset";
    case PF_IMU_REASON_GYRO_IN_DEGREES:
      return filled("its rates are %.1f times the camera's: are they in degrees per second? The library wants rad/s",
                    value);
    case PF_IMU_REASON_GYRO_SCALE:
      return filled("its rates are %.3g times the camera's: which unit are they in? The library wants rad/s", value);
    case PF_IMU_REASON_AXES:
      return filled("its axes are %.0f degrees from the mounting that was given; what fits is: ", value) +
             axes_in_words(report.reason_q_BC) + " (check --imu-mount, or leave it away to have the axes found)";
    case PF_IMU_REASON_LEFT_HANDED:
      return "its rates fit the camera's only with a reflection: one axis, or all three, have the wrong sign, or two "
             "are "
             "exchanged (axes must be right-handed)";
    case PF_IMU_REASON_CLOCK:
      return filled("its clock is another: a delay of %.1f ms fits", 1e3 * value) +
             filled(" (--imu-offset %.4f)", value);
    case PF_IMU_REASON_RATES_DO_NOT_FIT:
      return "its rates fit the camera's rotations with no axes and no delay within 0.2 s; is the file of this "
             "recording, and "
             "on its clock (--imu-offset, --imu-clock first-sample)?";
    case PF_IMU_REASON_COLUMNS_SWAPPED:
      return filled("its rates read %.2f, like gravity: are accelerations and rates exchanged in the file?", value);
    case PF_IMU_REASON_ACCEL_IN_G:
      return filled("the accelerometer reads %.2f m/s^2 in place of 9.81: is it in g? Only the gyroscope is used",
                    value);
    case PF_IMU_REASON_ACCEL_WITHOUT_GRAVITY:
      return filled(
          "the accelerometer reads %.2f m/s^2 in place of 9.81: is gravity taken off? Only the gyroscope is used",
          value);
    case PF_IMU_REASON_ACCEL_UNIT:
      return filled(
          "the accelerometer reads %.3g m/s^2 in place of 9.81: which unit is it in? Only the gyroscope is used",
          value);
    case PF_IMU_REASON_ACCEL_SIGN:
      return "its accelerations contradict the pictures: they have the opposite sign (iOS gives gravity's direction): "
             "at rest they must show +9.81 "
             "m/s^2 "
             "upwards; only the gyroscope is used";
    default:
      return "";
  }
}

}  // namespace pf::capture
