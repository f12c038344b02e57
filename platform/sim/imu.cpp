#include "sim/imu.h"

#include <algorithm>
#include <cmath>

namespace pf::sim {
namespace {

enum Stream : std::uint64_t { kNoiseStream = 61, kWalkStream = 62, kStampStream = 63 };
constexpr double kStep = 2e-4;  // of central differences [s]

/// Pose of the unit: its axes and its origin in W.
Pose unit_of(const ImuOptions& o, const Pose& camera) {
  const Mat3 R_CB = o.R_BC.transposed();
  return {camera.R_WC * R_CB, camera.p_WC - camera.R_WC * (R_CB * o.p_BC)};
}

}  // namespace

void true_reading(const ImuOptions& o, const Trajectory& path, double t, Vec3& gyro, Vec3& accel) {
  const Pose a = unit_of(o, path(t - kStep)), now = unit_of(o, path(t)), b = unit_of(o, path(t + kStep));
  gyro = rotation_log(a.R_WC.transposed() * b.R_WC) * (0.5 / kStep);
  const Vec3 acceleration = (a.p_WC + b.p_WC - now.p_WC * 2) * (1 / (kStep * kStep));
  accel = now.R_WC.transposed() * (acceleration - o.gravity_W);
}

ImuSensor::ImuSensor(const ImuOptions& options, Trajectory path)
    : options_(options),
      path_(std::move(path)),
      noise_(options.seed, kNoiseStream),
      walk_(options.seed, kWalkStream),
      stamps_(options.seed, kStampStream),
      gyro_bias_(options.gyro_bias),
      accel_bias_(options.accel_bias) {}

bool ImuSensor::in_gap(std::int64_t count) const {
  const double t = time_of(count);
  return t >= options_.gap_at_s && t < options_.gap_at_s + options_.gap_s;
}

std::int64_t ImuSensor::next_ns() const {
  std::int64_t count = count_;
  while (in_gap(count)) ++count;
  return static_cast<std::int64_t>(std::llround(static_cast<double>(count) * 1e9 / options_.rate_hz));
}

/// Biases one interval on.
void ImuSensor::walk() {
  const double root = std::sqrt(options_.rate_hz);
  gyro_bias_ += walk_.normal3() * (options_.gyro_walk / root);
  accel_bias_ += walk_.normal3() * (options_.accel_walk / root);
  ++walked_;
}

pf_imu_sample_t ImuSensor::next() {
  const std::int64_t t_ns = next_ns();
  while (in_gap(count_)) ++count_;
  while (walked_ < count_) walk();
  Vec3 gyro, accel;
  true_reading(options_, path_, static_cast<double>(t_ns) * 1e-9, gyro, accel);
  const double root = std::sqrt(options_.rate_hz);
  Mat3 of_gyro, of_accel;
  of_gyro.m = options_.gyro_error;
  of_accel.m = options_.accel_error;
  gyro += of_gyro * gyro;
  accel += of_accel * accel;
  gyro += gyro * options_.gyro_scale;
  accel += accel * options_.accel_scale;
  gyro += gyro_bias_ + noise_.normal3() * (options_.gyro_density * root);
  accel += accel_bias_ + noise_.normal3() * (options_.accel_density * root);
  ++count_;
  double off_s = -options_.delay_s;
  if (options_.jitter_s > 0)
    off_s += std::clamp(stamps_.normal() * options_.jitter_s, -0.4 / options_.rate_hz, 0.4 / options_.rate_hz);
  const auto held = [](double v, double range) { return range > 0 ? std::clamp(v, -range, range) : v; };
  const double g = options_.gyro_range, a = options_.accel_range;
  return {t_ns + static_cast<std::int64_t>(std::llround(off_s * 1e9)),
          {held(gyro.x, g), held(gyro.y, g), held(gyro.z, g)},
          {held(accel.x, a), held(accel.y, a), held(accel.z, a)}};
}

Trajectory after_rest(Trajectory base, double rest_s, double ramp_s) {
  return [base = std::move(base), rest_s, ramp_s](double t) {
    const double u = std::clamp((t - rest_s) / ramp_s, 0.0, 1.0);
    const double ramped = ramp_s * (u * u * u - u * u * u * u / 2);  // the speed is 3 u^2 - 2 u^3 of its own
    return base(ramped + std::max(0.0, t - rest_s - ramp_s));
  };
}

}  // namespace pf::sim
