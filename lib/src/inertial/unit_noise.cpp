#include "inertial/unit_noise.h"

#include <algorithm>
#include <cmath>

#include "base/elapsed.h"
#include "inertial/tuning.h"

namespace pf {

using namespace tuning::unit_noise;

void UnitNoise::note_samples() {
  const auto value = [&](int i, int sensor) {
    const Scalar* v = sensor == kGyro ? imu_[i].gyro : imu_[i].accel;
    return Vec3(v[0], v[1], v[2]);
  };
  const std::int64_t median_ns = imu_.counts().median_ns;
  if (median_ns <= 0 || imu_.held() == 0) return;
  int first = imu_.held();
  while (first > 0 && imu_[first - 1].t_ns > data_.last_ns) --first;
  for (int i = std::max(first, 3); i < imu_.held(); ++i) {
    if (elapsed_ns(imu_[i - 3].t_ns, imu_[i].t_ns) > kMaxGap * median_ns) continue;
    for (int k = 0; k < 2; ++k) {
      const Vec3 d = value(i, k) - 2 * value(i - 1, k) + value(i - 2, k);
      const Vec3 before = value(i - 1, k) - 2 * value(i - 2, k) + value(i - 3, k);
      data_.second[k] += d.squaredNorm();
      data_.third[k] += (d - before).squaredNorm();
    }
    if (++data_.count == kWindow) close_window();
  }
  data_.last_ns = imu_[imu_.held() - 1].t_ns;
}

/// White noise of variance s² has second differences of 6 s² and third ones of 20 s². Motion that samples hardly resolve has far less in
/// the third than this ratio, and such a window is not used.
void UnitNoise::close_window() {
  const Scalar interval = static_cast<Scalar>(seconds(imu_.counts().median_ns));
  const Scalar density[2] = {settings_.unit.noise.gyro_density, settings_.unit.noise.accel_density};
  for (int k = 0; k < 2; ++k) {
    const Scalar n = 3 * static_cast<Scalar>(data_.count);
    const Scalar of_second = data_.second[k] / (6 * n), of_third = data_.third[k] / (20 * n);
    data_.second[k] = data_.third[k] = 0;
    if (of_third < kWhite * of_second) continue;
    const Scalar now = std::clamp(of_third * interval / (density[k] * density[k]), kLeast * kLeast, kMost * kMost);
    data_.white[k] += kGain * (std::clamp(now, data_.white[k] / kStep, data_.white[k] * kStep) - data_.white[k]);
  }
  data_.count = 0;
}

void UnitNoise::note_innovation(Sensor sensor, Scalar nis, int dof) {
  const Scalar share = std::min(nis / static_cast<Scalar>(dof), kMostOfFrame);
  data_.excess[sensor] = std::clamp(data_.excess[sensor] + kRate * (share - kSlack), Scalar(0), 2 * std::log(kMost));
}

Scalar UnitNoise::ratio(Sensor sensor) const {
  return std::clamp(std::sqrt(data_.white[sensor] * std::exp(data_.excess[sensor])), kLeast, kMost);
}

bool UnitNoise::is_at_bound(Sensor sensor) const { return !(ratio(sensor) < kNearBound * kMost); }

/// What errors of scale and of axes leave changes as slowly as a bias: the excess counts for its walk as well.
ImuNoise UnitNoise::now() const {
  ImuNoise noise = settings_.unit.noise;
  const Scalar gyro = ratio(kGyro), accel = ratio(kAccel);
  noise.gyro_density *= gyro;
  noise.accel_density *= accel;
  noise.gyro_walk *= std::exp(data_.excess[kGyro] / 2);
  noise.accel_walk *= std::exp(data_.excess[kAccel] / 2);
  return noise;
}

}  // namespace pf
