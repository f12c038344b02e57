#include "inertial/force_check.h"

#include <cmath>

#include "base/elapsed.h"
#include "inertial/tuning.h"

namespace pf {

using namespace tuning::force_check;

namespace {

constexpr double kTime = 2;  ///< [s] over which a hand's accelerations average out

}  // namespace

void ForceCheck::note(const Mat3& R_WB, bool follows) {
  if (imu_.held() == 0) return;
  int first = imu_.held();
  while (first > 0 && imu_[first - 1].t_ns > data_.last_ns) --first;
  data_.last_ns = imu_[imu_.held() - 1].t_ns;
  if (!follows) data_.count = 0;
  if (data_.count == 0) {
    data_.begin_ns = data_.last_ns;
    data_.sum.setZero();
    data_.length = 0;
    data_.count = 1;
    return;
  }
  for (int i = first; i < imu_.held(); ++i) {
    const Vec3 f(imu_[i].accel[0], imu_[i].accel[1], imu_[i].accel[2]);
    data_.sum += R_WB * f;
    data_.length += f.norm();
    ++data_.count;
  }
  if (data_.count > kMinSamples && seconds(elapsed_ns(data_.begin_ns, data_.last_ns)) > kTime) judge();
}

void ForceCheck::judge() {
  const Scalar n = static_cast<Scalar>(data_.count - 1), g = settings_.unit.gravity;
  const Scalar mean = data_.sum.norm() / n, length = data_.length / n;
  data_.count = 0;
  data_.value = mean;
  UnitReason reason = UnitReason::kAccelUnit;
  if (std::abs(mean - g) < kNear * g)
    reason = UnitReason::kNone;
  else if (std::abs(mean - 1) < kNear && length < 1 + 2 * kNear)
    reason = UnitReason::kAccelInG;
  else if (mean < kNone * g && length < g / 2)
    reason = UnitReason::kAccelWithoutGravity;
  if (reason != UnitReason::kNone && reason != data_.reason)
    settings_.hooks.say("the accelerometer's mean specific force is ", fixed(mean, 2), " in place of ", fixed(g, 2),
                        " m/s^2: only the gyroscope is used");
  data_.reason = reason;
}

}  // namespace pf
