#pragma once

#include <cstdint>

#include "frame/settings.h"
#include "geometry/so3.h"

/// The inertial unit's values, of either back end.

namespace pf {

class FilterSlam;
class KeyframeSlam;

/// What is known of the inertial unit and of gravity.
struct InertialView {
  Vec3 gravity_W, gyro_bias, accel_bias;
  Vec3 axis_W[2];           ///< about which gravity's error rotates it
  Scalar covariance[8][8];  ///< of (gravity, gyro bias, accelerometer bias)
  bool metric, from_motion, resting;
  int rests;
  Quat q_BC;
  Vec3 p_BC;
  double delay_s, readout_s;
  Intrinsics intrinsics;
  Scalar sigma[18];  ///< in the order of pf_inertial_t
};

/// Whether images contradict the inertial unit, and for how long they have in all.
struct UnitDoubt {
  bool doubted = false;
  std::int64_t doubted_ns = 0;
  int reason = 0;  ///< pf_imu_reason_t
  Scalar reason_value = 0;
  Mat3 reason_R_CB = Mat3::Identity();
  Scalar gyro_density = 0, accel_density = 0;  ///< as they are known now
};

UnitDoubt read_unit_doubt(const Settings& settings, const FilterSlam& slam);
UnitDoubt read_unit_doubt(const Settings& settings, const KeyframeSlam& slam);

/// False without the inertial motion model, or without a pose.
bool read_inertial(const Settings& settings, const FilterSlam& slam, InertialView* out);
/// The same, and before the map has its first depths.
bool read_inertial(const Settings& settings, const KeyframeSlam& slam, InertialView* out);

}  // namespace pf
