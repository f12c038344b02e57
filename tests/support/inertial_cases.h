#pragma once

// Random bodies with an inertial unit, their errors, and samples.

#include <vector>

#include "filter/inertial_rows.h"
#include "support/filter_cases.h"

namespace pf {

inline constexpr int kInertialRows = 17;
inline constexpr double kSampleInterval = 0.005;  // [s]
inline constexpr ImuNoise kUnitNoise = {Scalar(2e-4), Scalar(2e-3), Scalar(2e-5), Scalar(3e-3)};
using Vec17 = Eigen::Matrix<Scalar, kInertialRows, 1>;
using Mat17 = Eigen::Matrix<Scalar, kInertialRows, kInertialRows>;

inline Mat17 matrix17(const Scalar* values) {
  Mat17 m;
  for (int i = 0; i < kInertialRows; ++i)
    for (int j = 0; j < kInertialRows; ++j) m(i, j) = values[i * kInertialRows + j];
  return m;
}

inline Body random_inertial_body(SeededRandom& random) {
  Body body = random_body(random);
  body.gyro_bias = random.normals<3>(0.05);
  body.accel_bias = random.normals<3>(0.2);
  body.q_WG = random_turn(random, 1.5);
  return body;
}

inline Mounting random_mounting(SeededRandom& random) {
  return {random_turn(random, 1.5).toRotationMatrix(), random.normals<3>(0.2)};
}

/// A filter goes to a body whose camera accelerates.
inline void bend_to(const Body& body, const Bend& bend, Filter* filter) {
  Transition transition;
  inertial_rows::clear(&transition, body, BodyLayout::with_inertial_unit().dynamic_rows());
  transition.bend = bend;
  filter->predict(transition);
}

/// Of a hand that waves a unit about.
inline std::vector<ImuReading> random_readings(SeededRandom& random, int count) {
  std::vector<ImuReading> readings;
  for (int i = 0; i < count; ++i)
    readings.push_back({random.normals<3>(1), Vec3(random.normals<3>(2) + Vec3(0, Scalar(-9.81), 0))});
  return readings;
}

inline Preintegral preintegral_of(const std::vector<ImuReading>& readings, const Body& body) {
  Preintegral sum(kUnitNoise, body.gyro_bias, body.accel_bias);
  for (std::size_t i = 1; i < readings.size(); ++i)
    sum.add(static_cast<Scalar>(kSampleInterval), readings[i - 1], readings[i]);
  return sum;
}

/// The error of a body over its rows: theta, p, v, gyro bias, accelerometer bias, gravity.
inline Body moved_inertial(Body body, const Vec17& e) {
  body = moved(body, Vec6(e.head<6>()));
  body.v_W += e.segment<3>(6);
  body.gyro_bias += e.segment<3>(9);
  body.accel_bias += e.segment<3>(12);
  body.q_WG = body.q_WG * exp_so3(Vec3(e(15), e(16), Scalar(0)));
  return body;
}

inline Vec17 inertial_difference(const Body& a, const Body& b) {
  Vec17 e;
  e.head<3>() = log_so3(a.q_WC * b.q_WC.conjugate());
  e.segment<3>(3) = a.p_W - b.p_W;
  e.segment<3>(6) = a.v_W - b.v_W;
  e.segment<3>(9) = a.gyro_bias - b.gyro_bias;
  e.segment<3>(12) = a.accel_bias - b.accel_bias;
  e.tail<2>() = log_so3(b.q_WG.conjugate() * a.q_WG).head<2>();
  return e;
}

}  // namespace pf
