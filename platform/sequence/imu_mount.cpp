#include <array>
#include <cmath>
#include <vector>

#include "forms/form.h"
#include "forms/lens.h"
#include "imu_model.h"
#include "refuse.h"
#include "yaml_fields.h"

namespace pf::sequence {

namespace {

using Rotation = std::array<std::array<double, 3>, 3>;

constexpr double kMaxDelay = 0.5;        ///< [s] that the library takes
constexpr double kMaxSkew = 1e-3;        ///< of a rotation's entries
constexpr double kMaxLever = 10.0;       ///< [m] from camera to unit
constexpr double kMaxDifference = 1e-3;  ///< of two fields that say the same [m], and of rotations

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
      fields.refuse_field(key, "puts the unit " + format_number(t[i]) + " m away; lengths are in metres");
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

/// Names of a matrix of 4 x 4 numbers, and what it takes to what. Kalibr and OpenVINS have the inverse of each other.
struct Matrix {
  const char* key;
  bool from_imu;      ///< p_C = T p_B in place of p_B = T p_C
  const char* delay;  ///< field of the time offset beside it: t_imu = t_cam + offset; null: none
};
constexpr Matrix kMatrices[] = {{"T_cam_imu", true, "timeshift_cam_imu"},
                                {"T_imu_cam", false, "timeshift_cam_imu"},
                                {"T_BS", false, nullptr},
                                {"IMU.T_b_c1", false, nullptr},
                                {"Tbc", false, nullptr},
                                {"body_T_cam0", false, "td"},
                                {"body_T_cam1", false, "td"}};

constexpr const char* kKnown =
    "T_BS (EuRoC's cam0/sensor.yaml), T_cam_imu (Kalibr), T_imu_cam (OpenVINS, or 16 numbers; p_imu = T p_cam), "
    "body_T_cam0 (VINS-Fusion), extrinsicRotation (VINS-Mono), IMU.T_b_c1 and Tbc (ORB-SLAM)";

double read_delay(const Fields& fields, const char* key) {
  const double shift = key != nullptr ? fields.number_or(key, 0.0) : 0.0;
  if (!(std::fabs(shift) <= kMaxDelay)) {
    fields.refuse_field(key, "is " + format_number(shift) + " s; up to 0.5 either way are possible");
  }
  return -shift;
}

void require_same(const Fields& fields, const char* key, const pf_imu_model_t& a, const pf_imu_model_t& b) {
  double difference = 0.0, same_way = 0.0;
  for (size_t i = 0; i < 4; ++i) {
    same_way += a.q_BC[i] * b.q_BC[i];
  }
  for (size_t i = 0; i < 3; ++i) {
    difference = std::fmax(difference, std::fabs(a.p_BC[i] - b.p_BC[i]));
  }
  for (size_t i = 0; i < 4; ++i) {
    difference = std::fmax(difference, std::fabs(a.q_BC[i] - (same_way < 0.0 ? -b.q_BC[i] : b.q_BC[i])));
  }
  if (difference > kMaxDifference) {
    fields.refuse_field(key, "and another field say different mountings; remove the wrong one");
  }
}

/// VINS-Mono's rotation and translation from the camera to the unit.
bool read_parts(const Fields& fields, pf_imu_model_t* imu) {
  if (!fields.has("extrinsicRotation")) {
    return false;
  }
  const double estimate = fields.number_or("estimate_extrinsic", 0.0);
  if (estimate != 0.0 && estimate != 1.0) {
    fields.refuse_field("estimate_extrinsic", "is " + format_number(estimate) + ", so the mounting is not known");
  }
  const std::vector<double> R = fields.matrix("extrinsicRotation", 3, 3);
  const std::vector<double> t = fields.vector("extrinsicTranslation", 3);
  if (t.size() != 3) {
    fields.refuse_field("extrinsicTranslation", "must be three numbers");
  }
  set_mount(fields, "extrinsicRotation",
            {R[0], R[1], R[2], t[0], R[3], R[4], R[5], t[1], R[6], R[7], R[8], t[2], 0.0, 0.0, 0.0, 1.0}, false, imu);
  imu->delay_s = read_delay(fields, "td");
  return true;
}

void read_mount(const Fields& fields, const std::string& skipped, pf_imu_model_t* imu) {
  bool found = read_parts(fields, imu);
  for (const Matrix& matrix : kMatrices) {
    if (!fields.has(matrix.key) || skipped == matrix.key) {
      continue;
    }
    if (matrix.key == std::string("T_BS") && fields.text_or("sensor_type", "camera") == "imu") {
      refuse(fields.file() + ": T_BS is that of the unit itself; give the sensor.yaml of the camera (cam0)");
    }
    pf_imu_model_t read = *imu;
    set_mount(fields, matrix.key, fields.matrix(matrix.key, 4, 4), matrix.from_imu, &read);
    if (found) {
      require_same(fields, matrix.key, read, *imu);
    } else {
      read.delay_s = read_delay(fields, matrix.delay);
      *imu = read;
    }
    found = true;
  }
  if (!found) {
    refuse(fields.file() + ": says nowhere how the unit is mounted; known are " + kKnown);
  }
}

}  // namespace

void parse_imu_mount(const std::string& text, const std::string& file, const std::string& camera, pf_imu_model_t* imu,
                     std::vector<std::string>& notes) {
  const Fields top(text, file);
  Asked asked;
  asked.folders = {camera, "cam" + camera};
  const std::vector<NamedCamera> chain = kalibr_cameras(top);
  if (!chain.empty()) {
    read_mount(top.below(chain[choose_camera(top, chain, asked, false, notes)].name), "", imu);
    return;
  }
  std::vector<NamedCamera> bodies;
  for (const char* number : {"0", "1"}) {
    if (top.has(std::string("body_T_cam") + number)) {
      bodies.push_back({std::string("body_T_cam") + number, {std::string("cam") + number}});
    }
  }
  const size_t chosen = bodies.size() > 1 ? choose_camera(top, bodies, asked, false, notes) : 0;
  read_mount(top, bodies.size() > 1 ? bodies[1 - chosen].name : "", imu);
}

}  // namespace pf::sequence
