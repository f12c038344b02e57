// Intrinsics of an inertial unit, where they are estimated: a frame's transition and the one that replaces it, the reading at rest, what a
// rest says of gravity and bias, and P as constants move it. All against central differences.
#include "filter/imu_path.h"
#include "filter/inertial_motion.h"
#include "same.h"
#include "support/filter_cases.h"
#include "support/inertial_cases.h"
#include "support/numeric_jacobian.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr int kRows = 24, kFirst = kRows, kErrors = Intrinsics::kRows;
using Error = Intrinsics::Error;
using ByErrors = Eigen::Matrix<Scalar, 17, kErrors>;
constexpr Scalar kLoose = kNumericJacobianTolerance * 4;

BodyLayout layout_with_intrinsics() {
  BodyLayout layout = BodyLayout::with_inertial_unit();
  layout.add_mounting(true, true, true);
  layout.add_intrinsics();
  TEST_ASSERT_EQUAL_INT(kRows, layout.dynamic_rows());
  TEST_ASSERT_EQUAL_INT(kRows + kErrors, layout.unit_rows());
  TEST_ASSERT_EQUAL_INT(kFirst, layout.row(BodyPart::kIntrinsics));
  return layout;
}

Mounting mounting_with_intrinsics(SeededRandom& random) {
  Mounting mounting = random_mounting(random);
  mounting.intrinsics.open = true;
  Error e;
  for (int i = 0; i < kErrors; ++i) e(i) = Scalar(0.03 * random.normal());
  mounting.intrinsics.move(e);
  return mounting;
}

Mounting moved_by(Mounting mounting, const Error& e) {
  mounting.intrinsics.move(e);
  return mounting;
}

ByErrors by_errors(const Transition& t) {
  ByErrors J = ByErrors::Zero();
  for (int i = 0; t.has_intrinsics && i < 17; ++i)
    for (int j = 0; j < kErrors; ++j) J(i, j) = t.by_intrinsics[i * kErrors + j];
  return J;
}

Preintegral integrated(const std::vector<ImuReading>& readings, const Body& body, const Mounting& mounting,
                       bool coasts) {
  Preintegral sum(kUnitNoise, body.gyro_bias, body.accel_bias, mounting.intrinsics);
  for (std::size_t i = 1; i < readings.size(); ++i)
    sum.add(static_cast<Scalar>(kSampleInterval), readings[i - 1], readings[i]);
  if (coasts) sum.coast(Scalar(0.02), sum.rate(readings.back().gyro), Vec3(0, Scalar(9.81), 0), Scalar(1), Scalar(1));
  return sum;
}

template <typename Predict>
void check_transition(const char* name, Predict predict) {
  SeededRandom random(421);
  for (int trial = 0; trial < 10; ++trial) {
    const Body body = random_inertial_body(random);
    const Mounting mounting = mounting_with_intrinsics(random);
    const std::vector<ImuReading> readings = random_readings(random, 7);
    Transition transition, other;
    const auto go = [&](const Mounting& m, Transition* t) {
      predict(body, m, integrated(readings, body, m, trial % 2 != 0), t);
    };
    go(mounting, &transition);
    const auto moves = [&](const Error& e) -> Vec17 {
      go(moved_by(mounting, e), &other);
      return inertial_difference(other.mean, transition.mean);
    };
    check_jacobian<17, kErrors>(by_errors(transition), moves, name, Scalar(1), kLoose);
  }
}

void test_transition_by_the_intrinsics_should_be_exact() {
  const BodyLayout layout = layout_with_intrinsics();
  check_transition("by intrinsics", [&](const Body& b, const Mounting& m, const Preintegral& s, Transition* t) {
    predict_inertial(b, layout, m, s, Scalar(9.81), t);
  });
  check_transition("by intrinsics, gyro", [&](const Body& b, const Mounting& m, const Preintegral& s, Transition* t) {
    predict_rotation_only(b, layout, m, s, Scalar(1), t);
  });
}

/// Biases are in front of the intrinsics.
void test_transition_by_the_biases_should_be_exact_behind_intrinsics() {
  SeededRandom random(422);
  const BodyLayout layout = layout_with_intrinsics();
  for (int trial = 0; trial < 10; ++trial) {
    const Body body = random_inertial_body(random);
    const Mounting mounting = mounting_with_intrinsics(random);
    const std::vector<ImuReading> readings = random_readings(random, 7);
    Transition transition, other;
    predict_inertial(body, layout, mounting, integrated(readings, body, mounting, false), Scalar(9.81), &transition);
    const auto moves = [&](const Vec6& e) -> Vec17 {
      Body beside = body;
      beside.gyro_bias += e.head<3>();
      beside.accel_bias += e.tail<3>();
      predict_inertial(beside, layout, mounting, integrated(readings, beside, mounting, false), Scalar(9.81), &other);
      return inertial_difference(other.mean, transition.mean);
    };
    Eigen::Matrix<Scalar, 17, 6> F;
    for (int i = 0; i < 17; ++i)
      for (int j = 0; j < 6; ++j) F(i, j) = transition.F[i * kRows + 9 + j];
    check_jacobian<17, 6>(F, moves, "F by the biases", Scalar(1), kLoose);
  }
}

/// A rate that goes on without samples is what it was, and the bias is that reading less it again.
void test_bias_from_a_rate_should_be_exact_by_the_intrinsics() {
  SeededRandom random(423);
  const BodyLayout layout = layout_with_intrinsics();
  for (int trial = 0; trial < 10; ++trial) {
    Body body = random_inertial_body(random);
    body.w_C = random.normals<3>(1);
    const Mounting mounting = mounting_with_intrinsics(random);
    FreshReading fresh;
    fresh.gyro = random.normals<3>(1);
    Transition transition, other;
    begin_with_samples(body, layout, mounting, fresh, &transition);
    const auto biases = [&](const Error& e) -> Vec3 {
      begin_with_samples(body, layout, moved_by(mounting, e), fresh, &other);
      return other.mean.gyro_bias - transition.mean.gyro_bias;
    };
    check_jacobian<3, kErrors>(Eigen::Matrix<Scalar, 3, kErrors>(by_errors(transition).middleRows<3>(9)), biases,
                               "bias by intrinsics", Scalar(1), kLoose);
    begin_without_samples(body, layout, mounting, Scalar(0.1), false, Scalar(1), &other);
    TEST_ASSERT_TRUE((by_errors(other) + by_errors(transition)).norm() < Scalar(1e-6));
  }
}

void test_reading_at_rest_should_be_exact_by_the_intrinsics() {
  SeededRandom random(424);
  for (int trial = 0; trial < 10; ++trial) {
    TestFilter filter(true, layout_with_intrinsics());
    const Mounting mounting = mounting_with_intrinsics(random);
    filter->set_mounting(mounting);
    filter->set_mean(random_inertial_body(random));
    StillMeasurement z;
    const auto reads = [&](const Error& e) -> Vec6 {
      filter->set_mounting(moved_by(mounting, e));
      filter->predict_still(StillReading(), Scalar(9.81), &z);
      return z.predicted;
    };
    reads(Error::Zero());
    const Eigen::Matrix<Scalar, 6, kErrors> J = dense_rows(*filter, z.H).middleCols<kErrors>(kFirst).cast<Scalar>();
    check_jacobian<6, kErrors>(J, reads, "J_z_intrinsics at rest", Scalar(1), kLoose);
  }
}

/// Where the bias is drawn to nothing else: the part of it along gravity, and gravity.
void test_rest_should_be_exact_by_the_intrinsics() {
  SeededRandom random(425);
  const BodyLayout layout = layout_with_intrinsics();
  for (int trial = 0; trial < 10; ++trial) {
    const Body body = random_inertial_body(random);
    const Mounting mounting = mounting_with_intrinsics(random);
    RestReading rest;
    rest.accel = Scalar(9.7) * random.normals<3>(1).normalized();
    rest.gravity = Scalar(9.81);
    Transition transition, other;
    begin_at_rest(body, layout, mounting, rest, &transition);
    const Vec3 along = (mounting.intrinsics.D_a * rest.accel).normalized();
    const Mat3 R_GW = transition.mean.q_WG.toRotationMatrix().transpose();
    // Of an accelerometer whose intrinsics are others and whose bias across gravity is the same.
    const auto says = [&](const Error& e) -> Vec3 {
      const Mat3 D = moved_by(mounting, e).intrinsics.D_a, D_0 = mounting.intrinsics.D_a;
      const auto force_of = [&](Scalar b) {
        return Vec3(D * (rest.accel - transition.mean.accel_bias - D_0.inverse() * (b * along)));
      };
      Scalar b = 0;
      for (int round = 0; round < 20; ++round) b += force_of(b).norm() - rest.gravity;
      const Vec3 u = -(body.q_WC * (mounting.R_CB * force_of(b).normalized()));
      const Vec3 tilt = R_GW * transition.mean.gravity_W().cross(u);
      return Vec3(tilt.x(), tilt.y(), b);
    };
    const ByErrors all = by_errors(transition);
    Eigen::Matrix<Scalar, 3, kErrors> J;
    J.topRows<2>() = all.middleRows<2>(15);
    J.row(2) = along.transpose() * mounting.intrinsics.D_a * all.middleRows<3>(12);
    check_jacobian<3, kErrors>(J, says, "rest by intrinsics", Scalar(1), kLoose);
  }
}

/// The error of the state moves the intrinsics, and with them the rate that the samples say.
void test_error_of_the_intrinsics_should_move_the_state() {
  SeededRandom random(426);
  TestFilter filter(true, layout_with_intrinsics());
  const Mounting mounting = mounting_with_intrinsics(random);
  filter->set_mounting(mounting);
  Body body = random_inertial_body(random);
  body.w_C = random.normals<3>(1);
  filter->set_mean(body);
  Scalar dx[kRows + kErrors] = {};
  Error e;
  for (int i = 0; i < kErrors; ++i) dx[kFirst + i] = e(i) = Scalar(0.01 * random.normal());
  filter.move(dx);
  const Mounting expected = moved_by(mounting, e), &now = filter->state().mounting;
  const Scalar near = kNumericJacobianIsFloat ? Scalar(1e-5) : Scalar(1e-12);
  TEST_ASSERT_TRUE((now.intrinsics.D_w - expected.intrinsics.D_w).norm() < near);
  TEST_ASSERT_TRUE((now.intrinsics.D_a - expected.intrinsics.D_a).norm() < near);
  TEST_ASSERT_TRUE((now.reading_of(filter->state().body.w_C) - mounting.reading_of(body.w_C)).norm() < near);
}

/// x+ = F x + B c + noise over the whole state, and what takes it back.
void test_constants_should_move_the_covariance_as_a_full_transition_does() {
  SeededRandom random(427);
  const BodyLayout layout = layout_with_intrinsics();
  for (int trial = 0; trial < 5; ++trial) {
    TestFilter filter(true, layout);
    const Mounting mounting = mounting_with_intrinsics(random);
    const Body body = random_inertial_body(random);
    filter->set_mounting(mounting);
    filter->set_mean(body);
    filter->add_point(random.normals<3>(1), Mat3::Identity());
    filter.set_P(random_covariance(random, filter.dim(), 0.05));
    const Dense before = filter.P();
    Transition made, other;
    predict_inertial(body, layout, mounting, integrated(random_readings(random, 7), body, mounting, false),
                     Scalar(9.81), &made);
    predict_inertial(body, layout, mounting, integrated(random_readings(random, 7), body, mounting, true), Scalar(9.81),
                     &other);
    const auto moved = [&](const Transition& t) {
      Dense F = Dense::Identity(filter.dim(), filter.dim()), Q = Dense::Zero(filter.dim(), filter.dim());
      for (int i = 0; i < kRows; ++i) {
        for (int j = 0; j < kRows; ++j) {
          F(i, j) = static_cast<double>(t.F[i * kRows + j]);
          Q(i, j) = static_cast<double>(t.Q[i * kRows + j]);
        }
        for (int j = 0; j < kErrors; ++j) F(i, kFirst + j) = static_cast<double>(t.by_intrinsics[i * kErrors + j]);
      }
      return Dense(F * before * F.transpose() + Q);
    };
    const double near = kNumericJacobianIsFloat ? 1e-3 : 1e-9;
    filter->predict(made);
    TEST_ASSERT_TRUE((filter.P() - moved(made)).norm() < near * before.norm());
    const Dense expected = moved(other);
    replace_transition(made, &other);
    filter->predict(other);
    TEST_ASSERT_TRUE((filter.P() - expected).norm() < near * before.norm());
  }
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_transition_by_the_intrinsics_should_be_exact);
  RUN_TEST(test_transition_by_the_biases_should_be_exact_behind_intrinsics);
  RUN_TEST(test_bias_from_a_rate_should_be_exact_by_the_intrinsics);
  RUN_TEST(test_reading_at_rest_should_be_exact_by_the_intrinsics);
  RUN_TEST(test_rest_should_be_exact_by_the_intrinsics);
  RUN_TEST(test_error_of_the_intrinsics_should_move_the_state);
  RUN_TEST(test_constants_should_move_the_covariance_as_a_full_transition_does);
  return UNITY_END();
}
