#pragma once

#include <cstdint>

#include "filter/imu_log.h"
#include "frame/settings.h"
#include "inertial/unit_reason.h"

/// Tests whether the accelerometer reads specific force in m/s². Over seconds, in axes that do not rotate, a hand's accelerations average
/// out, and the mean is gravity's: about 9.81.

namespace pf {

class Archive;

class ForceCheck {
 public:
  ForceCheck(const Settings& settings, const ImuLog& imu) : settings_(settings), imu_(imu) {}

  void init() { data_ = Data(); }
  /// Notes a frame. R_WB: rotation of the unit, from images; follows: the frame before had one too.
  void note(const Mat3& R_WB, bool follows);
  /// kNone where the mean is gravity's, or is not known yet. *value: the mean reading [m/s^2].
  UnitReason reason(Scalar* value) const {
    *value = data_.value;
    return data_.reason;
  }

  void carry(Archive& archive);  ///< base/archive.h

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
