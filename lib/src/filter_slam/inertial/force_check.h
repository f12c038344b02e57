#pragma once

#include <cstdint>

#include "filter/imu_log.h"
#include "filter_slam/inertial/unit_reason.h"
#include "frame/settings.h"

/// Whether the accelerometer reads specific force in m/s². What a hand does averages out over seconds, in axes that do not rotate, and
/// gravity stays: about 9.81, whatever else is known.

namespace pf {

class ForceCheck {
 public:
  ForceCheck(const Settings& settings, const ImuLog& imu) : settings_(settings), imu_(imu) {}

  void init() { data_ = Data(); }
  /// After a frame. R_WB: of the unit, as the pictures have it; follows: they have it since the frame before.
  void note(const Mat3& R_WB, bool follows);
  /// kNone where gravity is seen or nothing is known yet. *value: what was read [m/s^2].
  UnitReason reason(Scalar* value) const {
    *value = data_.value;
    return data_.reason;
  }

 private:
  struct Data {
    std::int64_t last_ns = INT64_MIN, begin_ns = INT64_MIN;
    int count = 0;
    Vec3 sum = Vec3::Zero();
    Scalar length = 0;
    UnitReason reason = UnitReason::kNone;
    Scalar value = 0;
  };

  void judge();

  const Settings& settings_;
  const ImuLog& imu_;
  Data data_;
};

}  // namespace pf
