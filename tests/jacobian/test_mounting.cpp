// How an inertial unit is mounted and how late its clock is, where they are estimated: a frame's transition, the reading at rest, gravity
// as it is read at rest, and the preintegrated samples by a delay. All against central differences.
#include "filter/imu_path.h"
#include "filter/inertial_motion.h"
#include "same.h"
#include "support/inertial_cases.h"
#include "support/numeric_jacobian.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr int kTurn = 17, kPlace = 20, kDelay = 23, kRows = 24;
using Mounted = Eigen::Matrix<Scalar, 6, 1>;
constexpr Scalar kLoose = kNumericJacobianTolerance * 4;

BodyLayout layout_with_mounting() {
  BodyLayout layout = BodyLayout::with_inertial_unit();
  layout.add_mounting(true, true, true);
  TEST_ASSERT_EQUAL_INT(kRows, layout.rows());
  TEST_ASSERT_EQUAL_INT(kTurn, layout.row(BodyPart::kMountRotation));
  TEST_ASSERT_EQUAL_INT(kPlace, layout.row(BodyPart::kMountPlace));
  TEST_ASSERT_EQUAL_INT(kDelay, layout.row(BodyPart::kDelay));
  return layout;
}

Mounting moved_mounting(Mounting mounting, const Mounted& e) {
  mounting.R_CB = exp_so3(Vec3(e.head<3>())).toRotationMatrix() * mounting.R_CB;
  mounting.p_C += e.tail<3>();
  return mounting;
}

Eigen::Matrix<Scalar, 17, 6> by_mounting(const Transition& t) {
  Eigen::Matrix<Scalar, 17, 6> J;
  for (int i = 0; i < 17; ++i)
    for (int j = 0; j < 6; ++j) J(i, j) = t.F[i * kRows + kTurn + j];
  return J;
}

template <typename Predict>
void check_mounting(const char* name, bool in_metres, Predict predict) {
  SeededRandom random(401);
  for (int trial = 0; trial < 10; ++trial) {
    Body body = random_inertial_body(random);
    body.w_C = random.normals<3>(1);
    Mounting mounting = random_mounting(random);
    mounting.in_metres = in_metres;
    if (!in_metres) mounting.p_C.setZero();
    const Preintegral samples = preintegral_of(random_readings(random, 7), body);
    Transition transition, other;
    predict(body, mounting, samples, &transition);
    TEST_ASSERT_EQUAL_INT(kRows, transition.dim);
    const auto moves = [&](const Mounted& e) -> Vec17 {
      Mounted counted = e;
      if (!in_metres) counted.tail<3>().setZero();
      Body same = body;  // the samples keep their axes, and the rate of the camera follows
      same.w_C = exp_so3(Vec3(e.head<3>())) * body.w_C;
      predict(same, moved_mounting(mounting, counted), samples, &other);
      return inertial_difference(other.mean, transition.mean);
    };
    check_jacobian<17, 6>(by_mounting(transition), moves, name, Scalar(1), kLoose);
  }
}

void test_transition_by_the_mounting_should_be_exact() {
  const BodyLayout layout = layout_with_mounting();
  check_mounting("F by mounting", true, [&](const Body& b, const Mounting& m, const Preintegral& s, Transition* t) {
    predict_inertial(b, layout, m, s, Scalar(9.81), t);
  });
  check_mounting("F by mounting, gyro", false,
                 [&](const Body& b, const Mounting& m, const Preintegral& s, Transition* t) {
                   predict_rotation_only(b, layout, m, s, Scalar(1), t);
                 });
  check_mounting("F by mounting, no samples", true,
                 [&](const Body& b, const Mounting& m, const Preintegral&, Transition* t) {
                   predict_without_samples(b, layout, m, Scalar(0.04), {Scalar(1), Scalar(2)}, t);
                 });
}

/// A unit that is waved about smoothly, sampled so often that the mid-point rule leaves nothing.
struct Waved {
  static constexpr std::int64_t kIntervalNs = 200000;
  TestArena arena;
  ImuLog log;

  explicit Waved(SeededRandom& random) {
    log.layout(*arena, 2000);
    log.init(2000, {});
    const Vec3 w = random.normals<3>(1), dw = random.normals<3>(1), a = random.normals<3>(3), da = random.normals<3>(3);
    for (int k = 0; k < 1000; ++k) {
      const Scalar t = static_cast<Scalar>(k) * Scalar(2e-4);
      const Vec3 gyro = w + std::sin(8 * t) * dw, accel = a + std::cos(7 * t) * da + Vec3(0, Scalar(-9.81), 0);
      log.add({k * kIntervalNs, {gyro.x(), gyro.y(), gyro.z()}, {accel.x(), accel.y(), accel.z()}});
    }
  }
  /// Between two frames, for a delay that is longer by so much [s].
  Preintegral integrate(const Body& body, Scalar longer) const {
    const auto shift = static_cast<std::int64_t>(static_cast<double>(longer) * 1e9);
    Preintegral sum(kUnitNoise, body.gyro_bias, body.accel_bias);
    ImuReading end;
    integrate_samples(log, 60050000 - shift, 93030000 - shift, Coasting(), &sum, &end);
    return sum;
  }
};

void test_transition_by_the_delay_should_be_exact() {
  SeededRandom random(402);
  const BodyLayout layout = layout_with_mounting();
  const Scalar h = Scalar(kNumericJacobianIsFloat ? 1e-2 : 2e-3);
  for (int trial = 0; trial < 10; ++trial) {
    const Body body = random_inertial_body(random);
    const Mounting mounting = random_mounting(random);
    const Waved unit(random);
    for (int gyro_only = 0; gyro_only < 2; ++gyro_only) {
      const auto predict = [&](Scalar longer, Transition* t) {
        if (gyro_only != 0)
          predict_rotation_only(body, layout, mounting, unit.integrate(body, longer), Scalar(1), t);
        else
          predict_inertial(body, layout, mounting, unit.integrate(body, longer), Scalar(9.81), t);
      };
      Transition at, more, less;
      predict(Scalar(0), &at);
      predict(h, &more);
      predict(-h, &less);
      const Vec17 slope = inertial_difference(more.mean, less.mean) / (2 * h);
      for (int i = 0; i < 17; ++i) {
        const Scalar J = at.F[i * kRows + kDelay];
        if (std::abs(J - slope(i)) > Scalar(kNumericJacobianIsFloat ? 3e-2 : 2e-3) * (1 + slope.cwiseAbs().maxCoeff()))
          std::printf("row %d by the delay: %.9g, numerically %.9g\n", i, static_cast<double>(J),
                      static_cast<double>(slope(i)));
        TEST_ASSERT_TRUE(std::abs(J - slope(i)) <=
                         Scalar(kNumericJacobianIsFloat ? 3e-2 : 2e-3) * (1 + slope.cwiseAbs().maxCoeff()));
      }
    }
  }
}

void test_reading_at_rest_should_be_exact_by_the_axes_of_the_unit() {
  SeededRandom random(403);
  for (int trial = 0; trial < 10; ++trial) {
    TestFilter filter(true, layout_with_mounting());
    const Mounting mounting = random_mounting(random);
    filter->set_mounting(mounting);
    filter->set_mean(random_inertial_body(random));
    StillMeasurement z;
    const auto reads = [&](const Mounted& e) -> Vec6 {
      filter->set_mounting(moved_mounting(mounting, e));
      filter->predict_still(StillReading(), Scalar(9.81), &z);
      return z.predicted;
    };
    reads(Mounted::Zero());
    const Eigen::Matrix<Scalar, 6, 6> J = dense_rows(*filter, z.H).middleCols<6>(kTurn).cast<Scalar>();
    check_jacobian<6, 6>(J, reads, "J_z_mounting at rest", Scalar(1), kLoose);
  }
}

/// Gravity is read in the axes of the unit, and so its direction in W hangs on them.
void test_gravity_at_rest_should_be_exact_by_the_axes_of_the_unit() {
  SeededRandom random(404);
  const BodyLayout layout = layout_with_mounting();
  for (int trial = 0; trial < 10; ++trial) {
    const Body body = random_inertial_body(random);
    const Mounting mounting = random_mounting(random);
    RestReading rest;
    rest.accel = random.normals<3>(5);
    rest.gravity = Scalar(9.81);
    Transition transition, other;
    begin_at_rest(body, layout, mounting, rest, &transition);
    const auto tilts = [&](const Mounted& e) -> Vec2 {
      begin_at_rest(body, layout, moved_mounting(mounting, e), rest, &other);
      const Vec3 tilt = transition.mean.gravity_W().cross(other.mean.gravity_W());
      return transition.mean.q_WG.toRotationMatrix().leftCols<2>().transpose() * tilt;
    };
    Eigen::Matrix<Scalar, 2, 6> J;
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 6; ++j) J(i, j) = transition.F[(15 + i) * kRows + kTurn + j];
    check_jacobian<2, 6>(J, tilts, "gravity by mounting", Scalar(1), kLoose);
    // What is known of the mounting stays.
    for (int i = kTurn; i < kRows; ++i)
      for (int j = 0; j < kRows; ++j) TEST_ASSERT_SAME(Scalar(i == j ? 1 : 0), transition.F[i * kRows + j]);
  }
}

/// The error of the state moves the mounting as the Jacobians say, and the rate with it.
void test_error_of_the_mounting_should_move_the_state() {
  SeededRandom random(405);
  TestFilter filter(true, layout_with_mounting());
  const Mounting mounting = random_mounting(random);
  filter->set_mounting(mounting);
  const Body body = random_inertial_body(random);
  filter->set_mean(body);
  Scalar dx[kRows] = {};
  Mounted e;
  e << Scalar(0.1), Scalar(-0.2), Scalar(0.05), Scalar(0.01), Scalar(0.02), Scalar(-0.03);
  for (int i = 0; i < 6; ++i) dx[kTurn + i] = e(i);
  dx[kDelay] = Scalar(0.004);
  filter.move(dx);
  const Mounting expected = moved_mounting(mounting, e), &now = filter->state().mounting;
  const Scalar near = kNumericJacobianIsFloat ? Scalar(1e-5) : Scalar(1e-12);
  TEST_ASSERT_TRUE((now.R_CB - expected.R_CB).norm() < near && (now.p_C - expected.p_C).norm() < near);
  TEST_ASSERT_SAME(Scalar(0.004), now.delay);
  const Vec3 w_B = mounting.R_CB.transpose() * body.w_C;
  TEST_ASSERT_TRUE((now.R_CB.transpose() * filter->state().body.w_C - w_B).norm() < near);
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_transition_by_the_mounting_should_be_exact);
  RUN_TEST(test_transition_by_the_delay_should_be_exact);
  RUN_TEST(test_reading_at_rest_should_be_exact_by_the_axes_of_the_unit);
  RUN_TEST(test_gravity_at_rest_should_be_exact_by_the_axes_of_the_unit);
  RUN_TEST(test_error_of_the_mounting_should_move_the_state);
  return UNITY_END();
}
