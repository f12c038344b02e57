// Transitions of the motion models: F against central differences, the noise a covariance, two half steps one whole one. The integrals of
// the rotation that constant acceleration is made of, against sums.
#include "filter/motion.h"
#include "geometry/turn_integrals.h"
#include "model/gauge.h"
#include "same.h"
#include "support/filter_cases.h"
#include "support/numeric_jacobian.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr int kDim = kBodyRows;
using Vec12 = Eigen::Matrix<Scalar, kDim, 1>;
using Mat12 = Eigen::Matrix<Scalar, kDim, kDim>;

constexpr MotionNoise kNoise = {Scalar(0.8), Scalar(1.7)};
constexpr Scalar kExact = kNumericJacobianIsFloat ? Scalar(1e-5) : Scalar(1e-13);

Mat12 matrix(const Scalar* values, int dim) {
  Mat12 m = Mat12::Zero();
  for (int i = 0; i < dim; ++i)
    for (int j = 0; j < dim; ++j) m(i, j) = values[i * dim + j];
  return m;
}

Body plus(Body body, const Vec12& e) {
  body = moved(body, e.head<6>());
  body.v_W += e.segment<3>(6);
  body.w_C += e.tail<3>();
  return body;
}

Vec12 minus(const Body& a, const Body& b) {
  Vec12 e;
  e.head<3>() = log_so3(a.q_WC * b.q_WC.conjugate());
  e.segment<3>(3) = a.p_W - b.p_W;
  e.segment<3>(6) = a.v_W - b.v_W;
  e.tail<3>() = a.w_C - b.w_C;
  return e;
}

void test_transition_of_constant_velocity_should_be_exact() {
  SeededRandom random(51);
  for (int trial = 0; trial < 50; ++trial) {
    const Body before = random_body(random);
    const Scalar dt = static_cast<Scalar>(random.uniform(0.005, 1));
    Transition transition, moved_transition;
    predict_constant_velocity(before, BodyLayout::with_constant_velocity(), dt, kNoise, &transition);
    const Body& after = transition.mean;
    TEST_ASSERT_EQUAL_INT(kDim, transition.dim);
    const auto moves = [&](const Vec12& e) {
      predict_constant_velocity(plus(before, e), BodyLayout::with_constant_velocity(), dt, kNoise, &moved_transition);
      return minus(moved_transition.mean, after);
    };
    check_jacobian<kDim, kDim>(matrix(transition.F, kDim), moves, "F");
  }
}

void test_transition_of_a_known_change_of_velocity_should_be_exact() {
  SeededRandom random(56);
  for (int trial = 0; trial < 50; ++trial) {
    const Body before = random_body(random);
    const Vec3 dv_C = random.normals<3>(0.5), dw_C = random.normals<3>(0.5);
    Transition transition, moved_transition;
    change_velocity(before, BodyLayout::with_constant_velocity(), dv_C, dw_C, &transition);
    const auto moves = [&](const Vec12& e) {
      change_velocity(plus(before, e), BodyLayout::with_constant_velocity(), dv_C, dw_C, &moved_transition);
      return minus(moved_transition.mean, transition.mean);
    };
    check_jacobian<kDim, kDim>(matrix(transition.F, kDim), moves, "F");
  }
}

void test_transition_of_constant_position_should_be_the_identity() {
  SeededRandom random(52);
  const Body before = random_body(random);
  Transition transition;
  predict_constant_position(before, BodyLayout::with_constant_position(), Scalar(0.1), kNoise, &transition);
  TEST_ASSERT_EQUAL_INT(Body::kPoseDim, transition.dim);
  TEST_ASSERT_SAME(0, minus(transition.mean, before).norm());
  for (int i = 0; i < 36; ++i) TEST_ASSERT_SAME((i % 7 == 0 ? Scalar(1) : Scalar(0)), transition.F[i]);
}

/// Symmetric to rounding, and positive definite, by elimination.
void check_noise(const Transition& transition) {
  const int n = transition.dim;
  Dense Q = matrix(transition.Q, n).topLeftCorner(n, n).cast<double>();
  // Scaled to a diagonal of one, so that one bound does for every power of dt.
  const Eigen::VectorXd d = Q.diagonal().cwiseSqrt().cwiseInverse();
  Q = d.asDiagonal() * Q * d.asDiagonal();
  const Dense asymmetry = Q - Q.transpose();
  TEST_ASSERT_TRUE(asymmetry.cwiseAbs().maxCoeff() < (kNumericJacobianIsFloat ? 1e-6 : 1e-15));
  for (int j = 0; j < n; ++j) {
    TEST_ASSERT_TRUE_MESSAGE(Q(j, j) > 1e-3, "the noise is not positive");
    for (int i = j + 1; i < n; ++i) Q.row(i) -= Q(i, j) / Q(j, j) * Q.row(j);
  }
}

void test_noise_should_be_symmetric_and_positive_for_short_and_long_steps() {
  SeededRandom random(53);
  for (const double dt : {1e-4, 0.01, 0.033, 0.5, 2.0}) {
    Body body = random_body(random);
    Transition transition;
    predict_constant_velocity(body, BodyLayout::with_constant_velocity(), static_cast<Scalar>(dt), kNoise, &transition);
    check_noise(transition);
    predict_constant_position(body, BodyLayout::with_constant_position(), static_cast<Scalar>(dt), kNoise, &transition);
    check_noise(transition);
  }
}

/// P through one step of dt, or through `steps` of dt / steps.
Mat12 through(Body* body, Scalar dt, int steps) {
  Mat12 P = Mat12::Zero();
  for (int i = 0; i < steps; ++i) {
    Transition t;
    predict_constant_velocity(*body, BodyLayout::with_constant_velocity(), dt / static_cast<Scalar>(steps), kNoise, &t);
    *body = t.mean;
    const Mat12 F = matrix(t.F, kDim), FP = F.lazyProduct(P);
    P = Mat12(FP.lazyProduct(F.transpose())) + matrix(t.Q, kDim);
  }
  return P;
}

void test_two_half_steps_should_be_one_whole_step_when_the_camera_does_not_turn() {
  SeededRandom random(54);
  Body whole = random_body(random);
  whole.w_C.setZero();
  Body halves = whole;
  const Mat12 P1 = through(&whole, Scalar(0.2), 1), P2 = through(&halves, Scalar(0.2), 2);
  TEST_ASSERT_TRUE(minus(whole, halves).norm() < kExact);
  TEST_ASSERT_TRUE((P1 - P2).cwiseAbs().maxCoeff() < kExact);
}

void test_two_half_steps_should_be_one_whole_step_to_first_order_in_the_turn() {
  SeededRandom random(55);
  for (int trial = 0; trial < 20; ++trial) {
    const Body start = random_body(random);
    Scalar error[2];
    for (int k = 0; k < 2; ++k) {
      const Scalar dt = k == 0 ? Scalar(0.2) : Scalar(0.1);
      Body whole = start, halves = start;
      const Mat12 P1 = through(&whole, dt, 1), P2 = through(&halves, dt, 2);
      TEST_ASSERT_TRUE(minus(whole, halves).norm() < kExact);  // the mean is exact
      // Entries have different powers of dt: each against its own standard deviations.
      error[k] = 0;
      for (int i = 0; i < kDim; ++i)
        for (int j = 0; j < kDim; ++j)
          error[k] = std::max(error[k], std::abs(P1(i, j) - P2(i, j)) / std::sqrt(P1(i, i) * P1(j, j)));
      TEST_ASSERT_TRUE(error[k] < start.w_C.norm() * dt);
    }
    // At least linear in dt: half the step, at most about half the error.
    if (!kNumericJacobianIsFloat) TEST_ASSERT_TRUE(error[1] < Scalar(0.6) * error[0]);
  }
}

void test_variance_should_grow_as_the_densities_say() {
  Body body;
  const Scalar dt = Scalar(0.25);
  Transition t;
  predict_constant_velocity(body, BodyLayout::with_constant_velocity(), dt, kNoise, &t);
  const Mat12 Q = matrix(t.Q, kDim);
  const Scalar q2 = kNoise.linear * kNoise.linear, a2 = kNoise.angular * kNoise.angular;
  TEST_ASSERT_TRUE(std::abs(Q(6, 6) - q2 * dt) < kExact && std::abs(Q(9, 9) - a2 * dt) < kExact);
  TEST_ASSERT_TRUE(std::abs(Q(3, 3) - q2 * dt * dt * dt / 3) < kExact);
  TEST_ASSERT_TRUE(std::abs(Q(3, 6) - q2 * dt * dt / 2) < kExact && std::abs(Q(0, 9) - a2 * dt * dt / 2) < kExact);
  predict_constant_position(body, BodyLayout::with_constant_position(), dt, kNoise, &t);
  TEST_ASSERT_TRUE(std::abs(t.Q[0] - a2 * dt) < kExact && std::abs(t.Q[3 * 6 + 3] - q2 * dt) < kExact);
}

/// int_0^1 w(s) Exp(s phi) ds by Simpson's rule.
template <typename Weight>
Mat3 sum_of_rotations(const Vec3& phi, Weight weight) {
  constexpr int kSteps = 400;  // even
  Mat3 sum = Mat3::Zero();
  for (int i = 0; i <= kSteps; ++i) {
    const Scalar s = static_cast<Scalar>(i) / kSteps;
    const int times = i == 0 || i == kSteps ? 1 : i % 2 == 1 ? 4 : 2;
    sum += static_cast<Scalar>(times) * weight(s) * exp_so3(Vec3(s * phi)).toRotationMatrix();
  }
  return sum / (3 * kSteps);
}

const Scalar kTurns[] = {Scalar(0), Scalar(1e-4), Scalar(0.05), Scalar(0.199), Scalar(0.201), Scalar(1), Scalar(4)};

void test_integrals_of_a_turn_should_be_sums_of_its_rotations() {
  SeededRandom random(57);
  const auto once = [](Scalar) { return Scalar(1); };
  const auto ramp = [](Scalar s) { return 2 * s; };
  const auto back = [](Scalar s) { return 2 * (1 - s); };
  for (const Scalar angle : kTurns) {
    const Vec3 phi = angle * random.normals<3>(1).normalized();
    const Scalar bound = kNumericJacobianIsFloat ? Scalar(2e-5) : Scalar(1e-9);
    const Mat3 T = turn_integral_of_ramp(phi).matrix();
    TEST_ASSERT_TRUE((turn_integral(phi).matrix() - sum_of_rotations(phi, once)).cwiseAbs().maxCoeff() < bound);
    TEST_ASSERT_TRUE((turn_integral(phi).matrix() - left_jacobian_so3(phi)).cwiseAbs().maxCoeff() < bound);
    TEST_ASSERT_TRUE((T - sum_of_rotations(phi, ramp)).cwiseAbs().maxCoeff() < bound);
    // As the paper has it, with the world in the camera.
    const Mat3 seen_back = exp_so3(Vec3(-phi)).toRotationMatrix().lazyProduct(T);
    TEST_ASSERT_TRUE((seen_back - sum_of_rotations(Vec3(-phi), back)).cwiseAbs().maxCoeff() < bound);
  }
}

void test_integrals_of_a_turn_should_have_exact_derivatives() {
  SeededRandom random(58);
  using Mat33 = Eigen::Matrix<Scalar, 3, 3>;
  for (const Scalar angle : kTurns) {
    const Vec3 phi = angle * random.normals<3>(1).normalized(), x = random.normals<3>(1);
    const auto both = [&](TurnIntegral (*integral)(const Vec3&), const char* name) {
      const Vec3 here = integral(phi).matrix() * x;
      const auto moves = [&](const Eigen::Matrix<Scalar, 3, 1>& e) {
        return Eigen::Matrix<Scalar, 3, 1>(integral(Vec3(phi + e)).matrix() * x - here);
      };
      check_jacobian<3, 3>(Mat33(integral(phi).by_phi(x)), moves, name);
    };
    both(turn_integral, "S");
    both(turn_integral_of_ramp, "T");
  }
}

using Vec15 = Eigen::Matrix<Scalar, 15, 1>;
using Mat15 = Eigen::Matrix<Scalar, 15, 15>;
const BodyLayout kAccelerated = BodyLayout::with_constant_acceleration();

Mat15 matrix15(const Scalar* values) {
  Mat15 m;
  for (int i = 0; i < 15; ++i)
    for (int j = 0; j < 15; ++j) m(i, j) = values[i * 15 + j];
  return m;
}

Body plus15(const Body& before, const Vec15& e) {
  Body body = plus(before, e.head<12>());
  body.a_C += e.tail<3>();
  return body;
}

Vec15 minus15(const Body& a, const Body& b) {
  Vec15 e;
  e << minus(a, b), a.a_C - b.a_C;
  return e;
}

Body random_accelerated_body(SeededRandom& random) {
  Body body = random_body(random);
  body.a_C = random.normals<3>(1);
  return body;
}

void test_transition_of_constant_acceleration_should_be_exact() {
  SeededRandom random(59);
  for (int trial = 0; trial < 50; ++trial) {
    const Body before = random_accelerated_body(random);
    const Scalar dt = static_cast<Scalar>(random.uniform(0.005, 1));
    Transition transition, moved_transition;
    predict_constant_acceleration(before, kAccelerated, dt, kNoise, &transition);
    const Body& after = transition.mean;
    TEST_ASSERT_EQUAL_INT(15, transition.dim);
    const auto moves = [&](const Vec15& e) {
      predict_constant_acceleration(plus15(before, e), kAccelerated, dt, kNoise, &moved_transition);
      return minus15(moved_transition.mean, after);
    };
    check_jacobian<15, 15>(matrix15(transition.F), moves, "F");
  }
}

/// Against many short steps along a straight line each, whose velocity turns with the camera.
void test_constant_acceleration_should_be_that_of_the_velocity_in_camera_axes() {
  SeededRandom random(60);
  constexpr int kSteps = 20000;
  for (int trial = 0; trial < 5; ++trial) {
    const Body before = random_accelerated_body(random);
    const Scalar dt = Scalar(0.5), step = dt / kSteps;
    Transition transition;
    predict_constant_acceleration(before, kAccelerated, dt, kNoise, &transition);
    Vec3 p = before.p_W;
    const Vec3 v_C = before.q_WC.conjugate() * before.v_W;
    for (int i = 0; i < kSteps; ++i) {
      const Scalar s = (static_cast<Scalar>(i) + Scalar(0.5)) * step;
      p += step * (before.q_WC * exp_so3(Vec3(before.w_C * s)) * Vec3(v_C + s * before.a_C));
    }
    const Vec3 v = transition.mean.q_WC * Vec3(v_C + dt * before.a_C);
    TEST_ASSERT_TRUE((transition.mean.p_W - p).norm() < (kNumericJacobianIsFloat ? Scalar(1e-3) : Scalar(1e-8)));
    TEST_ASSERT_TRUE((transition.mean.v_W - v).norm() < (kNumericJacobianIsFloat ? Scalar(1e-5) : Scalar(1e-12)));
  }
}

void test_noise_of_constant_acceleration_should_be_symmetric_and_positive() {
  SeededRandom random(61);
  for (const Scalar dt : {Scalar(0.01), Scalar(0.033), Scalar(0.5)}) {
    Body body = random_accelerated_body(random);
    body.v_W *= Scalar(0.1);
    Transition t;
    predict_constant_acceleration(body, kAccelerated, dt, kNoise, &t);
    Eigen::MatrixXd Q = matrix15(t.Q).cast<double>();
    const Eigen::VectorXd d = Q.diagonal().cwiseSqrt().cwiseInverse();
    Q = d.asDiagonal() * Q * d.asDiagonal();
    TEST_ASSERT_TRUE((Q - Q.transpose()).cwiseAbs().maxCoeff() < (kNumericJacobianIsFloat ? 1e-6 : 1e-14));
    for (int j = 0; j < 15; ++j) {
      TEST_ASSERT_TRUE(Q(j, j) > 1e-5);
      for (int i = j + 1; i < 15; ++i) Q.row(i) -= Q(i, j) / Q(j, j) * Q.row(j);
    }
    const Scalar q2 = kNoise.linear * kNoise.linear;
    TEST_ASSERT_TRUE(std::abs(t.Q[12 * 15 + 12] / (q2 * dt) - 1) < Scalar(1e-5));
    TEST_ASSERT_TRUE(std::abs(t.Q[3 * 15 + 3] / (q2 * std::pow(dt, Scalar(5)) / 20) - 1) < Scalar(1e-5));
  }
}

/// What moves all of the world before moves all of it after: F N = N+.
void test_constant_acceleration_should_carry_every_direction_of_the_gauge() {
  SeededRandom random(62);
  const auto gauge_of = [](const Body& body) {
    Eigen::Matrix<Scalar, 15, 7> N = Eigen::Matrix<Scalar, 15, 7>::Zero();
    for_each_body_gauge(body, kAccelerated, Mounting(),
                        [&](int first, int rows, const GaugeRowsOf<3>& part) { N.middleRows(first, rows) = part; });
    return N;
  };
  for (int trial = 0; trial < 20; ++trial) {
    const Body before = random_accelerated_body(random);
    Transition t, damped;
    predict_constant_acceleration(before, kAccelerated, Scalar(0.1), kNoise, &t);
    damp_acceleration(before, kAccelerated, Scalar(0.7), Scalar(1), &damped);
    const Scalar bound = kNumericJacobianIsFloat ? Scalar(1e-4) : Scalar(1e-12);
    TEST_ASSERT_TRUE((matrix15(t.F) * gauge_of(before) - gauge_of(t.mean)).cwiseAbs().maxCoeff() < bound);
    TEST_ASSERT_TRUE((matrix15(damped.F) * gauge_of(before) - gauge_of(damped.mean)).cwiseAbs().maxCoeff() < bound);
  }
}

void test_an_acceleration_of_which_nothing_is_measured_should_go_back_to_its_prior() {
  SeededRandom random(63);
  const Body body = random_accelerated_body(random);
  Transition t;
  damp_acceleration(body, kAccelerated, Scalar(0.5), Scalar(2), &t);
  TEST_ASSERT_TRUE((t.mean.a_C - body.a_C / 2).norm() < Scalar(1e-6));
  for (int i = 0; i < 15; ++i) {
    TEST_ASSERT_SAME(i < 12 ? Scalar(1) : Scalar(0.5), t.F[i * 15 + i]);
    TEST_ASSERT_SAME(i < 12 ? Scalar(0) : Scalar(3), t.Q[i * 15 + i]);  // (1 - 1/4) 2^2
  }
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_transition_of_constant_velocity_should_be_exact);
  RUN_TEST(test_transition_of_a_known_change_of_velocity_should_be_exact);
  RUN_TEST(test_transition_of_constant_position_should_be_the_identity);
  RUN_TEST(test_noise_should_be_symmetric_and_positive_for_short_and_long_steps);
  RUN_TEST(test_two_half_steps_should_be_one_whole_step_when_the_camera_does_not_turn);
  RUN_TEST(test_two_half_steps_should_be_one_whole_step_to_first_order_in_the_turn);
  RUN_TEST(test_variance_should_grow_as_the_densities_say);
  RUN_TEST(test_integrals_of_a_turn_should_be_sums_of_its_rotations);
  RUN_TEST(test_integrals_of_a_turn_should_have_exact_derivatives);
  RUN_TEST(test_transition_of_constant_acceleration_should_be_exact);
  RUN_TEST(test_constant_acceleration_should_be_that_of_the_velocity_in_camera_axes);
  RUN_TEST(test_noise_of_constant_acceleration_should_be_symmetric_and_positive);
  RUN_TEST(test_constant_acceleration_should_carry_every_direction_of_the_gauge);
  RUN_TEST(test_an_acceleration_of_which_nothing_is_measured_should_go_back_to_its_prior);
  return UNITY_END();
}
