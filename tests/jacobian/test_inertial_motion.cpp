// The inertial motion model: preintegrated samples by the biases, a frame's transition by every row of the body, the begin at rest,
// and the pixels of a rolling shutter whose rows hang on the gyro. All against central differences.
#include "filter/inertial_motion.h"
#include "observe/point.h"
#include "same.h"
#include "support/filter_cases.h"
#include "support/inertial_cases.h"
#include "support/numeric_jacobian.h"
#include "support/test_cameras.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

using Vec9 = Eigen::Matrix<Scalar, 9, 1>;

Vec9 values_of(const Preintegral& sum, const Mat3& R_at) {
  Vec9 e;
  e << log_so3(Quat(Mat3(sum.R() * R_at.transpose()))), sum.v(), sum.p();
  return e;
}

void test_preintegral_should_be_exact_by_the_biases() {
  SeededRandom random(301);
  for (int trial = 0; trial < 10; ++trial) {
    const Body body = random_inertial_body(random);
    const std::vector<ImuReading> readings = random_readings(random, 8);
    const Preintegral sum = preintegral_of(readings, body);
    const auto moves = [&](const Vec6& e) {
      Body other = body;
      other.gyro_bias += e.head<3>();
      other.accel_bias += e.tail<3>();
      return values_of(preintegral_of(readings, other), sum.R());
    };
    check_jacobian<9, 6>(sum.by_bias(), moves, "by_bias");
  }
}

/// White noise of samples: its covariance against that of many draws.
void test_preintegral_s_covariance_should_be_that_of_noisy_samples() {
  SeededRandom random(302);
  const Body body = random_inertial_body(random);
  const std::vector<ImuReading> readings = random_readings(random, 40);
  const Preintegral sum = preintegral_of(readings, body);
  constexpr int kDraws = 3000;
  Eigen::Matrix<double, 9, 9> C = Eigen::Matrix<double, 9, 9>::Zero();
  for (int k = 0; k < kDraws; ++k) {
    std::vector<ImuReading> noisy = readings;
    for (ImuReading& r : noisy) {
      r.gyro += random.normals<3>(static_cast<double>(kUnitNoise.gyro_density) / std::sqrt(kSampleInterval));
      r.accel += random.normals<3>(static_cast<double>(kUnitNoise.accel_density) / std::sqrt(kSampleInterval));
    }
    const Vec9 off = values_of(preintegral_of(noisy, body), sum.R()) - values_of(sum, sum.R());
    const Eigen::Matrix<double, 9, 1> e = off.cast<double>();
    C += e * e.transpose() / kDraws;
  }
  for (int i = 0; i < 9; ++i) {
    const double ratio = C(i, i) / static_cast<double>(sum.covariance()(i, i));
    if (!(ratio > 0.85 && ratio < 1.15)) std::printf("row %d: drawn by stated variance %.3f\n", i, ratio);
    TEST_ASSERT_TRUE(ratio > 0.85 && ratio < 1.15);
  }
}

template <typename Predict>
void check_transition(SeededRandom& random, const char* name, Predict predict) {
  for (int trial = 0; trial < 10; ++trial) {
    const Body body = random_inertial_body(random);
    const Mounting mounting = random_mounting(random);
    const std::vector<ImuReading> readings = random_readings(random, 7);
    Transition transition, other;
    predict(body, mounting, readings, &transition);
    TEST_ASSERT_EQUAL_INT(kInertialRows, transition.dim);
    const auto moves = [&](const Vec17& e) {
      predict(moved_inertial(body, e), mounting, readings, &other);
      return inertial_difference(other.mean, transition.mean);
    };
    check_jacobian<kInertialRows, kInertialRows>(matrix17(transition.F), moves, name, Scalar(1),
                                                 kNumericJacobianTolerance * 4);
  }
}

void test_transition_of_the_inertial_model_should_be_exact() {
  SeededRandom random(303);
  const auto predict = [](const Body& body, const Mounting& mounting, const std::vector<ImuReading>& readings,
                          Transition* transition) {
    predict_inertial(body, BodyLayout::with_inertial_unit(), mounting, preintegral_of(readings, body), Scalar(9.81),
                     transition);
  };
  check_transition(random, "F", predict);
}

void test_transition_without_gravity_should_be_exact() {
  SeededRandom random(304);
  const auto predict = [](const Body& body, const Mounting& mounting, const std::vector<ImuReading>& readings,
                          Transition* transition) {
    predict_rotation_only(body, BodyLayout::with_inertial_unit(), mounting, preintegral_of(readings, body), Scalar(1),
                          transition);
  };
  check_transition(random, "F without gravity", predict);
}

/// A prediction that is taken back: the covariance is what the other transition alone makes of the one before.
void test_transition_that_is_replaced_should_leave_nothing_of_itself() {
  SeededRandom random(308);
  const BodyLayout layout = BodyLayout::with_inertial_unit();
  for (int trial = 0; trial < 10; ++trial) {
    const Body body = random_inertial_body(random);
    const Mounting mounting = random_mounting(random);
    const Preintegral samples = preintegral_of(random_readings(random, 7), body);
    Preintegral path(kUnitNoise, body.gyro_bias, body.accel_bias);
    path.coast(samples.dt(), random.normals<3>(1), random.normals<3>(9), Scalar(2), Scalar(1));
    Transition made, alone, replacing;
    predict_inertial(body, layout, mounting, samples, Scalar(9.81), &made);
    predict_inertial(body, layout, mounting, path, Scalar(9.81), &alone);
    predict_inertial(body, layout, mounting, path, Scalar(9.81), &replacing);
    replace_transition(made, &replacing);
    Mat17 A;
    for (int j = 0; j < kInertialRows; ++j) A.col(j) = random.normals<kInertialRows>(0.1);
    const Mat17 P = A * A.transpose();
    const auto after = [](const Transition& t, const Mat17& before) -> Mat17 {
      return matrix17(t.F) * before * matrix17(t.F).transpose() + matrix17(t.Q);
    };
    TEST_ASSERT_TRUE((after(replacing, after(made, P)) - after(alone, P)).cwiseAbs().maxCoeff() <
                     Scalar(kNumericJacobianIsFloat ? 1e-5 : 1e-12));
    TEST_ASSERT_TRUE((matrix17(replacing.F) * matrix17(made.F) - matrix17(alone.F)).cwiseAbs().maxCoeff() <
                     Scalar(kNumericJacobianIsFloat ? 1e-5 : 1e-13));
    TEST_ASSERT_SAME(Scalar(0), inertial_difference(replacing.mean, alone.mean).norm());
  }
}

/// Without samples the rows of the gyro's bias are the angular velocity's: e_w = -R_CB e_b.
void test_transition_without_samples_should_be_exact() {
  SeededRandom random(306);
  const MotionNoise noise = {Scalar(1), Scalar(2)};
  const Scalar dt = Scalar(0.04);
  const BodyLayout layout = BodyLayout::with_inertial_unit();
  for (int trial = 0; trial < 10; ++trial) {
    Body body = random_inertial_body(random);
    body.w_C = random.normals<3>(1);
    const Mounting mounting = random_mounting(random);
    Transition transition, other;
    predict_without_samples(body, layout, mounting, dt, noise, &transition);
    const auto moves = [&](const Vec17& e) {
      Body beside = moved_inertial(body, e);
      beside.w_C -= mounting.R_CB * Vec3(e.segment<3>(9));
      predict_without_samples(beside, layout, mounting, dt, noise, &other);
      Vec17 difference = inertial_difference(other.mean, transition.mean);
      difference.segment<3>(9) = -mounting.R_CB.transpose() * (other.mean.w_C - transition.mean.w_C);
      return difference;
    };
    check_jacobian<kInertialRows, kInertialRows>(matrix17(transition.F), moves, "F without samples", Scalar(1),
                                                 kNumericJacobianTolerance * 4);
    // The noise of the rate is that of constant velocity.
    const Mat17 Q = matrix17(transition.Q);
    for (int i = 0; i < 3; ++i) {
      TEST_ASSERT_TRUE(std::abs(Q(9 + i, 9 + i) - 4 * dt) < Scalar(1e-6));
      TEST_ASSERT_TRUE(std::abs(Q(6 + i, 6 + i) - dt) < Scalar(1e-6));
    }
  }
}

/// Samples that are used again: the bias has the error of the rate, and gravity that of the rotation that its direction was seen with.
void test_return_to_samples_should_be_exact() {
  SeededRandom random(307);
  const BodyLayout layout = BodyLayout::with_inertial_unit();
  for (int trial = 0; trial < 10; ++trial) {
    Body body = random_inertial_body(random);
    body.w_C = random.normals<3>(1);
    const Mounting mounting = random_mounting(random);
    FreshReading fresh;
    fresh.gyro = random.normals<3>(1);
    fresh.anew = true;
    fresh.gravity_W = random.normals<3>(9);
    Transition transition, other;
    begin_with_samples(body, layout, mounting, fresh, &transition);
    const auto moves = [&](const Vec17& e) {
      Body beside = moved_inertial(body, e);
      beside.w_C -= mounting.R_CB * Vec3(e.segment<3>(9));
      FreshReading seen = fresh;  // with the rotation that it was seen in
      seen.gravity_W = exp_so3(Vec3(e.head<3>())) * fresh.gravity_W;
      begin_with_samples(beside, layout, mounting, seen, &other);
      Vec17 difference = inertial_difference(other.mean, transition.mean);
      const Vec3 tilt = transition.mean.gravity_W().cross(other.mean.gravity_W());
      difference.tail<2>() = transition.mean.q_WG.toRotationMatrix().leftCols<2>().transpose() * tilt;
      return difference;
    };
    check_jacobian<kInertialRows, kInertialRows>(matrix17(transition.F), moves, "F of the return", Scalar(1),
                                                 kNumericJacobianTolerance * 4);
  }
}

/// The truth of a body at rest drawn from what begin_at_rest says: its readings are those that were given.
void test_begin_at_rest_should_hang_gravity_and_the_accelerometer_s_bias_together() {
  SeededRandom random(305);
  for (int trial = 0; trial < 10; ++trial) {
    const Body before = random_inertial_body(random);
    const Mounting mounting = random_mounting(random);
    RestReading rest;
    rest.gyro = random.normals<3>(0.02);
    rest.accel = random.normals<3>(5);
    rest.accel *= Scalar(9.7) / rest.accel.norm();
    rest.sigma_gyro = Scalar(1e-4);
    rest.sigma_accel = Scalar(1e-3);
    rest.sigma_speed = Scalar(0.01);
    rest.sigma_accel_bias = Scalar(0.1);
    rest.gravity = Scalar(9.81);
    Transition transition;
    begin_at_rest(before, BodyLayout::with_inertial_unit(), mounting, rest, &transition);
    const Body& body = transition.mean;
    // The mean explains the reading; and so does every error of the covariance, to first order.
    const auto reading = [&](const Vec17& e) -> Vec3 {
      const Body true_body = moved_inertial(body, e);
      const Mat3 R_WB = true_body.q_WC.toRotationMatrix() * mounting.R_CB;
      return R_WB.transpose() * (-rest.gravity * true_body.gravity_W()) + true_body.accel_bias;
    };
    TEST_ASSERT_TRUE((reading(Vec17::Zero()) - rest.accel).norm() < Scalar(1e-5));
    const Eigen::Matrix<Scalar, 3, kInertialRows> J = numeric_jacobian<3, kInertialRows>(reading, kNumericJacobianStep);
    // Of the pose before: 1e-2 rad, 1 m. Through F and Q.
    Mat17 P = Mat17::Zero();
    for (int i = 0; i < 6; ++i) P(i, i) = Scalar(1e-4);
    const Mat17 F = matrix17(transition.F);
    const Mat17 now = F * P * F.transpose() + matrix17(transition.Q);
    const Mat3 of_reading = J * now * J.transpose();
    const Scalar expected = rest.sigma_accel * rest.sigma_accel;
    TEST_ASSERT_TRUE((of_reading - Mat3::Identity() * expected).cwiseAbs().maxCoeff() <
                     (kNumericJacobianIsFloat ? Scalar(1e-4) : Scalar(0.01) * expected));
  }
}

/// What a unit at rest reads, by every row of the body.
void test_reading_at_rest_should_be_exact_by_every_row_of_the_body() {
  SeededRandom random(309);
  for (int trial = 0; trial < 10; ++trial) {
    TestFilter filter(true, BodyLayout::with_inertial_unit());
    filter->set_mounting(random_mounting(random));
    const Body body = random_inertial_body(random);
    StillMeasurement z;
    const auto reads = [&](const Vec17& e) -> Vec6 {
      filter->set_mean(moved_inertial(body, e));
      filter->predict_still(StillReading(), Scalar(9.81), &z);
      return z.predicted;
    };
    reads(Vec17::Zero());
    const Eigen::Matrix<Scalar, 6, kInertialRows> J = dense_rows(*filter, z.H).leftCols<kInertialRows>().cast<Scalar>();
    check_jacobian<6, kInertialRows>(J, reads, "J_z_body at rest", Scalar(1), kNumericJacobianTolerance * 4);
  }
}

/// Pixels of a rolling shutter, by every row of a body with a unit beside the camera.
void test_pixels_of_late_rows_should_be_exact_by_every_row_of_the_body() {
  SeededRandom random(306);
  for (int trial = 0; trial < 20; ++trial) {
    Camera camera = test_camera_of(trial % kTestCameras);
    camera.readout = Scalar(0.03);
    TestFilter filter(true, BodyLayout::with_inertial_unit());
    const Mounting mounting = random_mounting(random);
    filter->set_mounting(mounting);
    const Body body = random_inertial_body(random);
    const Bend bend = {random.normals<3>(10), random.normals<3>(5)};
    bend_to(body, bend, &*filter);
    const Vec3 p_W = point_in_view(random, body);
    const int slot = filter->add_point(p_W, Mat3::Identity());
    const auto seen = [&](const Vec17& e) -> Vec2 {
      Body other = moved_inertial(body, e);
      other.w_C -= mounting.R_CB * e.segment<3>(9);
      filter->set_mean(other);
      PixelMeasurement o;
      TEST_ASSERT_TRUE(filter->predict_pixel(camera, slot, &o));
      return o.predicted;
    };
    filter->set_mean(body);
    PixelMeasurement o;
    TEST_ASSERT_TRUE(filter->predict_pixel(camera, slot, &o));
    // Where the camera of the row sees the point: its speed is that of the unit's origin less what the rotation adds, and it accelerates.
    const Scalar tau = row_time(camera, o.predicted.y());
    const Vec3 v_W = body.v_W - body.q_WC * body.w_C.cross(mounting.p_C);
    const Quat q_WC = body.q_WC * exp_so3(Vec3(body.w_C * tau + tau * tau / 2 * bend.alpha_C));
    const Vec3 camera_W = body.p_W + v_W * tau + body.q_WC * (tau * tau / 2 * bend.a_C);
    Vec2 expected;
    TEST_ASSERT_TRUE(project(camera, q_WC.conjugate() * (p_W - camera_W), &expected));
    TEST_ASSERT_TRUE((o.predicted - expected).norm() < Scalar(0.05));
    const Eigen::Matrix<Scalar, 2, kInertialRows> J = dense_rows(*filter, o.H).leftCols<kInertialRows>().cast<Scalar>();
    check_jacobian<2, kInertialRows>(J, seen, "J_z_body", Scalar(0.5), Scalar(4e-3));
  }
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_preintegral_should_be_exact_by_the_biases);
  RUN_TEST(test_preintegral_s_covariance_should_be_that_of_noisy_samples);
  RUN_TEST(test_transition_of_the_inertial_model_should_be_exact);
  RUN_TEST(test_transition_without_gravity_should_be_exact);
  RUN_TEST(test_transition_without_samples_should_be_exact);
  RUN_TEST(test_transition_that_is_replaced_should_leave_nothing_of_itself);
  RUN_TEST(test_return_to_samples_should_be_exact);
  RUN_TEST(test_begin_at_rest_should_hang_gravity_and_the_accelerometer_s_bias_together);
  RUN_TEST(test_reading_at_rest_should_be_exact_by_every_row_of_the_body);
  RUN_TEST(test_pixels_of_late_rows_should_be_exact_by_every_row_of_the_body);
  return UNITY_END();
}
