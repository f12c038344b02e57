#include "imu_model.h"

#include <cstdio>
#include <vector>

#include "refuse.h"
#include "yaml_fields.h"

namespace pf::sequence {

namespace {

/// A density, its names, and what units of any price have. Degrees in place of radians, or the noise of one sample in place of its
/// density, are outside.
struct Density {
  const char* name;
  const char* plain_name;
  const char* unit;
  double lowest, highest;
  double pf_imu_model_t::*field;
};

constexpr Density kDensities[] = {
    {"gyroscope_noise_density", "gyro_noise_density", "rad/s/sqrt(Hz)", 5e-6, 1e-2, &pf_imu_model_t::gyro_density},
    {"accelerometer_noise_density", "accel_noise_density", "m/s^2/sqrt(Hz)", 5e-5, 1.0, &pf_imu_model_t::accel_density},
    {"gyroscope_random_walk", "gyro_random_walk", "rad/s^2/sqrt(Hz)", 1e-8, 1e-3, &pf_imu_model_t::gyro_walk},
    {"accelerometer_random_walk", "accel_random_walk", "m/s^3/sqrt(Hz)", 1e-7, 1e-1, &pf_imu_model_t::accel_walk},
};

constexpr double kInflated = 0.1;  ///< [m/s^2/sqrt(Hz)] a density of the accelerometer that no unit has
constexpr double kMinGravity = 9.0, kMaxGravity = 11.0;  ///< [m/s^2] that the library takes

std::string format(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%g", value);
  return text;
}

void read_imu_noise(const Fields& top, pf_imu_model_t* imu, std::vector<std::string>& notes) {
  const Fields fields = top.has("imu0") ? top.below("imu0") : top;
  if (top.has("imu0") && top.has("imu1")) {
    notes.push_back(top.file() + ": has several units; the noise of imu0 is taken");
  }
  const bool plain = fields.has(kDensities[0].plain_name) || fields.has(kDensities[1].plain_name);
  Fields::Known known{
      {}, {"rostopic", "update_rate", "rate_hz", "sensor_type", "comment", "T_BS", "T_i_b", "time_offset", "model"}};
  for (const Density& density : kDensities) {
    known.read.emplace_back(plain ? density.plain_name : density.name);
  }
  known.read.emplace_back("gravity");
  // The plain fields may lie in the calibration of the camera, whose own fields say nothing of the unit.
  if (plain && fields.has("camera_model")) known.unused.push_back("*");
  std::vector<std::string> ignored;
  fields.check_keys(known, plain ? ignored : notes);
  for (const Density& density : kDensities) {
    const char* key = plain ? density.plain_name : density.name;
    const double value = fields.number(key);
    if (!(value >= density.lowest && value <= density.highest)) {
      fields.refuse_field(key, "is " + format(value) + " " + density.unit + "; units have " + format(density.lowest) +
                                   " to " + format(density.highest) +
                                   ". Is it in degrees or g, or the noise of single samples?");
    }
    imu->*density.field = value;
  }
  if (imu->accel_density >= kInflated) {
    notes.push_back(
        top.file() + ": an accelerometer's density of " + format(imu->accel_density) +
        " m/s^2/sqrt(Hz) is far above what units have; it is learned from the samples, down to a third of that");
  }
  if (fields.has("gravity")) {
    const double gravity = fields.number("gravity");
    if (!(gravity >= kMinGravity && gravity <= kMaxGravity)) {
      fields.refuse_field("gravity", "is " + format(gravity) + " m/s^2; 9 to 11 are possible, and 9.81 without it");
    }
    imu->gravity = gravity;
  }
}

}  // namespace

void parse_imu_noise(const std::string& text, const std::string& file, pf_imu_model_t* imu,
                     std::vector<std::string>& notes) {
  read_with_hints(Fields(text, file), [&](const Fields& fields) {
    notes.clear();
    read_imu_noise(fields, imu, notes);
  });
}

}  // namespace pf::sequence
