#include "imu_model.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <vector>

#include "refuse.h"
#include "yaml_fields.h"

namespace pf::sequence {

namespace {

/// A density and what units of any price have. Degrees in place of radians, or the noise of one sample in place of its density, are
/// outside.
struct Density {
  const char* unit;
  double lowest, highest;
  double pf_imu_model_t::*field;
};

constexpr size_t kDensities = 4;
constexpr Density kDensity[kDensities] = {
    {"rad/s/sqrt(Hz)", 5e-6, 1e-2, &pf_imu_model_t::gyro_density},
    {"m/s^2/sqrt(Hz)", 5e-5, 1.0, &pf_imu_model_t::accel_density},
    {"rad/s^2/sqrt(Hz)", 1e-8, 1e-3, &pf_imu_model_t::gyro_walk},
    {"m/s^3/sqrt(Hz)", 1e-7, 1e-1, &pf_imu_model_t::accel_walk},
};

/// Whose names these are, in the order of kDensity.
struct Names {
  const char* name[kDensities];
  bool is_own_file;  ///< any other key of the file is about the unit as well
};
constexpr Names kKalibr = {
    {"gyroscope_noise_density", "accelerometer_noise_density", "gyroscope_random_walk", "accelerometer_random_walk"},
    true};
constexpr Names kPlain = {{"gyro_noise_density", "accel_noise_density", "gyro_random_walk", "accel_random_walk"},
                          false};
constexpr Names kOrbSlam = {{"IMU.NoiseGyro", "IMU.NoiseAcc", "IMU.GyroWalk", "IMU.AccWalk"}, false};

constexpr const char* kKnownNames =
    "gyroscope_noise_density (Kalibr, EuRoC, Allan's curves), gyro_noise_density (plain), IMU.NoiseGyro (ORB-SLAM3), "
    "and Gyr and Acc with "
    "avg-axis (imu_utils)";

constexpr double kInflated = 0.1;  ///< [m/s^2/sqrt(Hz)] a density of the accelerometer that no unit has
constexpr double kMinGravity = 9.0, kMaxGravity = 11.0;  ///< [m/s^2] that the library takes

std::string format(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%g", value);
  return text;
}

void set_density(const Fields& fields, const char* key, size_t i, double value, pf_imu_model_t* imu) {
  const Density& density = kDensity[i];
  if (!(value >= density.lowest && value <= density.highest)) {
    fields.refuse_field(key, "is " + format(value) + " " + density.unit + "; units have " + format(density.lowest) +
                                 " to " + format(density.highest) +
                                 ". Is it in degrees or g, or the noise of single samples?");
  }
  imu->*density.field = value;
}

/// Which names a file has. Refuses a file with none.
const Names& names_in(const Fields& fields) {
  for (const Names* names : {&kPlain, &kOrbSlam}) {
    if (fields.has(names->name[0]) || fields.has(names->name[1])) {
      return *names;
    }
  }
  if (fields.has_any({kKalibr.name[0], kKalibr.name[1], kKalibr.name[2], kKalibr.name[3]})) {
    return kKalibr;
  }
  if (fields.has_any({"acc_n", "gyr_n"})) {
    refuse(fields.file() + ": VINS' acc_n and gyr_n are made larger by hand, for single samples; give densities as " +
           kKalibr.name[0] + ", per root Hz");
  }
  refuse(fields.file() + ": says nowhere how noisy the unit is; known are " + kKnownNames);
}

/// imu_utils: the noise of single samples, and bias instabilities in place of walks.
void read_imu_utils(const Fields& top, pf_imu_model_t* imu, std::vector<std::string>& notes) {
  constexpr double kUsualRate = 200.0;  // [1/s]
  const bool said = top.has_any({"update_rate", "rate_hz"});
  const double rate = top.has("update_rate") ? top.number("update_rate") : top.number_or("rate_hz", kUsualRate);
  if (!(rate >= 1.0 && rate <= 1e5)) {
    top.refuse_field(top.has("update_rate") ? "update_rate" : "rate_hz",
                     "is " + format(rate) + "; 1 to 1e5 Hz are possible");
  }
  top.check_keys({{"Gyr", "Acc", "update_rate", "rate_hz", "gravity"}, {"type", "name"}}, notes);
  const char* const keys[kDensities] = {"gyr_n", "acc_n", "gyr_w", "acc_w"};
  for (size_t i = 0; i < kDensities; ++i) {
    const Fields axes = top.below(i % 2 == 0 ? "Gyr" : "Acc").below("avg-axis");
    set_density(axes, keys[i], i, axes.number(keys[i]) / (i < 2 ? std::sqrt(rate) : 1.0), imu);
  }
  notes.push_back(top.file() + ": imu_utils' noise is of single samples and is divided by the root of " + format(rate) +
                  " Hz" + (said ? "" : ", a usual rate (add update_rate: HZ)"));
}

void read_gravity(const Fields& fields, pf_imu_model_t* imu) {
  if (!fields.has("gravity")) {
    return;
  }
  const double gravity = fields.number("gravity");
  if (!(gravity >= kMinGravity && gravity <= kMaxGravity)) {
    fields.refuse_field("gravity", "is " + format(gravity) + " m/s^2; 9 to 11 are possible, and 9.81 without it");
  }
  imu->gravity = gravity;
}

void read_imu_noise(const Fields& top, pf_imu_model_t* imu, std::vector<std::string>& notes) {
  if (top.has_any({"Gyr", "Acc"})) {
    read_imu_utils(top, imu, notes);
    read_gravity(top, imu);
    return;
  }
  const Fields fields = top.has("imu0") ? top.below("imu0") : top;
  if (top.has("imu0") && top.has("imu1")) {
    notes.push_back(top.file() + ": has several units; the noise of imu0 is taken");
  }
  const Names& names = names_in(fields);
  Fields::Known known{
      {}, {"rostopic", "update_rate", "rate_hz", "sensor_type", "comment", "T_BS", "T_i_b", "time_offset", "model"}};
  known.read.assign(std::begin(names.name), std::end(names.name));
  known.read.emplace_back("gravity");
  // Names that may lie in the calibration of a camera, whose own fields say nothing of the unit.
  if (!names.is_own_file && (fields.has("camera_model") || &names == &kOrbSlam)) {
    known.unused.push_back("*");
  }
  std::vector<std::string> ignored;
  fields.check_keys(known, names.is_own_file ? notes : ignored);
  for (size_t i = 0; i < kDensities; ++i) {
    set_density(fields, names.name[i], i, fields.number(names.name[i]), imu);
  }
  if (imu->accel_density >= kInflated) {
    notes.push_back(
        top.file() + ": an accelerometer's density of " + format(imu->accel_density) +
        " m/s^2/sqrt(Hz) is far above what units have; it is learned from the samples, down to a third of that");
  }
  read_gravity(fields, imu);
}

/// Lines "name = value", as scripts print them, as fields; any other text as it is. Refuses Kalibr's report.
std::string as_fields(const std::string& text, const std::string& file) {
  if (text.find("Noise density (discrete)") != std::string::npos) {
    refuse(file + ": is Kalibr's report for people; give the file that ends in -imu.yaml beside it");
  }
  std::string fields = text;
  if (text.find(':') == std::string::npos && text.find("density") != std::string::npos) {
    std::replace(fields.begin(), fields.end(), '=', ':');
  }
  return fields;
}

}  // namespace

void parse_imu_noise(const std::string& text, const std::string& file, pf_imu_model_t* imu,
                     std::vector<std::string>& notes) {
  read_with_hints(Fields(as_fields(text, file), file), [&](const Fields& fields) {
    notes.clear();
    read_imu_noise(fields, imu, notes);
  });
}

}  // namespace pf::sequence
