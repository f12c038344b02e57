#include "imu_model.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include "refuse.h"
#include "yaml_fields.h"

namespace pf::sequence {

namespace {

using Rotation = std::array<std::array<double, 3>, 3>;

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
    {"accelerometer_noise_density", "accel_noise_density", "m/s^2/sqrt(Hz)", 5e-5, 1e-1,
     &pf_imu_model_t::accel_density},
    {"gyroscope_random_walk", "gyro_random_walk", "rad/s^2/sqrt(Hz)", 1e-8, 1e-3, &pf_imu_model_t::gyro_walk},
    {"accelerometer_random_walk", "accel_random_walk", "m/s^3/sqrt(Hz)", 1e-7, 1e-1, &pf_imu_model_t::accel_walk},
};

constexpr double kMinGravity = 9.0, kMaxGravity = 11.0;  ///< [m/s^2] that the library takes
constexpr double kMaxDelay = 0.5;                        ///< [s] that the library takes
constexpr double kMaxSkew = 1e-3;                        ///< of a rotation's entries
constexpr double kMaxLever = 10.0;                       ///< [m] from camera to unit

std::string format(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%g", value);
  return text;
}

/// w x y z, w >= 0
std::array<double, 4> quaternion_of(const Rotation& R) {
  // The largest of the four is computed first, from the diagonal; the others from it.
  const double trace = R[0][0] + R[1][1] + R[2][2];
  std::array<double, 4> q{};
  size_t largest = 0;
  double most = trace;
  for (size_t i = 0; i < 3; ++i) {
    if (R[i][i] > most) {
      most = R[i][i];
      largest = i + 1;
    }
  }
  const double s = 2.0 * std::sqrt(1.0 + 2.0 * most - trace);
  if (largest == 0) {
    q = {s / 4.0, (R[2][1] - R[1][2]) / s, (R[0][2] - R[2][0]) / s, (R[1][0] - R[0][1]) / s};
  } else {
    const size_t i = largest - 1, j = (i + 1) % 3, k = (i + 2) % 3;
    q[0] = (R[k][j] - R[j][k]) / s;
    q[1 + i] = s / 4.0;
    q[1 + j] = (R[j][i] + R[i][j]) / s;
    q[1 + k] = (R[k][i] + R[i][k]) / s;
  }
  const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  for (double& c : q) {
    c /= q[0] < 0.0 ? -length : length;
  }
  return q;
}

/// p_B = T p_C, row-major 4x4, or its inverse.
void set_mount(const Fields& fields, const std::string& key, const std::vector<double>& T, bool inverse,
               pf_imu_model_t* imu) {
  if (T.size() != 16) {
    fields.refuse_field(key, "must be a matrix of 4 x 4 numbers");
  }
  if (T[12] != 0.0 || T[13] != 0.0 || T[14] != 0.0 || T[15] != 1.0) {
    fields.refuse_field(key, "must have 0, 0, 0, 1 as its last row");
  }
  Rotation R{};
  std::array<double, 3> t{};
  for (size_t i = 0; i < 3; ++i) {
    for (size_t j = 0; j < 3; ++j) {
      R[i][j] = inverse ? T[4 * j + i] : T[4 * i + j];
    }
    for (size_t j = 0; j < 3; ++j) {
      t[i] += inverse ? -T[4 * j + i] * T[4 * j + 3] : (i == j ? T[4 * i + 3] : 0.0);
    }
  }
  for (size_t i = 0; i < 3; ++i) {
    const size_t j = (i + 1) % 3, k = (i + 2) % 3;
    for (size_t c = 0; c < 3; ++c) {  // each column is the cross product of the other two
      const double cross = R[j][(c + 1) % 3] * R[k][(c + 2) % 3] - R[k][(c + 1) % 3] * R[j][(c + 2) % 3];
      if (!(std::fabs(R[i][c] - cross) < kMaxSkew)) {
        fields.refuse_field(key, "is no rotation and translation: its 3 x 3 part must be orthogonal and right-handed");
      }
    }
    if (!(std::fabs(t[i]) <= kMaxLever)) {
      fields.refuse_field(key, "puts the unit " + format(t[i]) + " m away; lengths are in metres");
    }
  }
  const std::array<double, 4> q = quaternion_of(R);
  for (size_t i = 0; i < 4; ++i) {
    imu->q_BC[i] = q[i];
  }
  for (size_t i = 0; i < 3; ++i) {
    imu->p_BC[i] = t[i];
  }
}

std::vector<double> matrix_of_rows(const Fields& fields, const std::string& key) {
  std::vector<double> all;
  for (const std::vector<double>& row : fields.rows(key, 4, 4)) {
    all.insert(all.end(), row.begin(), row.end());
  }
  return all;
}

}  // namespace

std::string parse_imu_noise(const std::string& text, const std::string& file, pf_imu_model_t* imu) {
  const Fields top(text, file);
  const Fields fields = top.has("imu0") ? top.below("imu0") : top;
  const bool plain = fields.has(kDensities[0].plain_name) || fields.has(kDensities[1].plain_name);
  Fields::Known known{
      {}, {"rostopic", "update_rate", "rate_hz", "sensor_type", "comment", "T_BS", "T_i_b", "time_offset", "model"}};
  for (const Density& density : kDensities) {
    known.read.emplace_back(plain ? density.plain_name : density.name);
  }
  known.read.emplace_back("gravity");
  // The plain fields may lie in the file of the camera, whose own are none of this function's business.
  const std::string unknown = fields.check_keys(known), ignored = plain ? std::string() : unknown;
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
  if (fields.has("gravity")) {
    const double gravity = fields.number("gravity");
    if (!(gravity >= kMinGravity && gravity <= kMaxGravity)) {
      fields.refuse_field("gravity", "is " + format(gravity) + " m/s^2; 9 to 11 are possible, and 9.81 without it");
    }
    imu->gravity = gravity;
  }
  return ignored;
}

void parse_imu_mount(const std::string& text, const std::string& file, pf_imu_model_t* imu) {
  const Fields top(text, file);
  const Fields fields = top.has("cam0") ? top.below("cam0") : top;
  if (fields.has("T_cam_imu")) {
    set_mount(fields, "T_cam_imu", matrix_of_rows(fields, "T_cam_imu"), true, imu);
    const double shift = fields.number_or("timeshift_cam_imu", 0.0);  // t_imu = t_cam + shift
    if (!(std::fabs(shift) <= kMaxDelay)) {
      fields.refuse_field("timeshift_cam_imu", "is " + format(shift) + " s; up to 0.5 either way are possible");
    }
    imu->delay_s = -shift;
  } else if (fields.has("T_imu_cam")) {
    set_mount(fields, "T_imu_cam", fields.numbers("T_imu_cam", 16), false, imu);
  } else if (fields.has("T_BS")) {
    if (fields.text_or("sensor_type", "camera") == "imu") {
      refuse(file + ": T_BS is that of the unit itself; give the sensor.yaml of the camera (cam0)");
    }
    set_mount(fields, "T_BS", fields.below("T_BS").numbers("data", 16), false, imu);
  } else {
    refuse(file +
           ": says nowhere how the unit is mounted: T_BS (EuRoC's cam0/sensor.yaml), T_cam_imu (Kalibr) or T_imu_cam "
           "(16 numbers, p_imu = T p_cam)");
  }
}

}  // namespace pf::sequence
