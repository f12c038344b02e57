// With an inertial unit the whole world can still be shifted, and turned with gravity, without any measurement or sample seeing it. Pixels
// see no change of scale either; samples do.
#include "filter/moving_start.h"
#include "filter/vertical.h"
#include "support/filter_scene.h"
#include "support/inertial_cases.h"
// After the library's own settings of Eigen.
#include <Eigen/Eigenvalues>

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr int kShiftAndTurn = 6, kAll = 7;

/// A filter with a small map, seen by a body with a unit beside its camera.
struct InertialScene {
  TestFilter filter{true, BodyLayout::with_inertial_unit()};
  Mounting mounting;
  std::vector<int> slots;

  explicit InertialScene(SeededRandom& random, bool beside = true) : mounting(random_mounting(random)) {
    if (!beside) mounting.p_C.setZero();
    filter->set_mounting(mounting);
    slots = fill_map(random, filter, 5, 6);
    Body body = random_inertial_body(random);
    body.q_WC = filter->state().body.q_WC;  // the map stays in view
    body.p_W = filter->state().body.p_W;
    filter->set_mean(body);
  }
};

void test_no_pixel_should_see_a_shift_a_turn_or_a_change_of_scale() {
  SeededRandom random(311);
  for (int trial = 0; trial < 10; ++trial) {
    InertialScene scene(random);
    scene.filter.set_P(random_covariance(random, scene.filter.dim(), 0.1));
    Camera camera = test_camera_of(trial % kTestCameras);
    camera.readout = Scalar(trial % 2) * Scalar(0.03);
    Bend bend;
    bend.alpha_C = random.normals<3>(20);
    // An acceleration is known in metres only, where the scale is none of the directions any more.
    const bool metric = trial / 2 % 2 == 1;
    if (metric) bend.a_C = random.normals<3>(10);
    bend_to(scene.filter->state().body, bend, &*scene.filter);
    const Dense N = scene.filter.gauge();
    for (const int slot : scene.slots) {
      PixelMeasurement o;
      TEST_ASSERT_TRUE(scene.filter->predict_pixel(camera, slot, &o));
      const Dense H = dense_rows(*scene.filter, o.H);
      for (int c = 0; c < (metric ? kShiftAndTurn : kAll); ++c)
        TEST_ASSERT_TRUE(largest(H * N.col(c)) < 1e-11 * (1 + largest(H) * largest(N.col(c))));
    }
  }
}

/// A covariance of nothing but gauge directions, N A N^T, is N A N^T at the new state, without the noise of the step.
template <typename Step>
void carries(const char* name, int directions, bool beside, SeededRandom& random, Step step) {
  for (int trial = 0; trial < 10; ++trial) {
    InertialScene scene(random, beside);
    const Dense A = random_covariance(random, directions, 1);
    const Dense before = scene.filter.gauge().leftCols(directions);
    scene.filter.set_P(before * A * before.transpose());
    Transition transition;
    step(scene, &transition);
    for (Scalar& q : transition.Q) q = Scalar(0);
    scene.filter->predict(transition);
    const Dense after = scene.filter.gauge().leftCols(directions);
    const Dense expected = after * A * after.transpose();
    const double error = largest(scene.filter.P() - expected) / largest(expected);
    if (!(error < 1e-12)) std::printf("%s: relative error %.3g\n", name, error);
    TEST_ASSERT_TRUE_MESSAGE(error < 1e-12, name);
  }
}

void test_samples_should_carry_shifts_and_turns() {
  SeededRandom random(312);
  carries("predict_inertial", kShiftAndTurn, true, random, [&](InertialScene& scene, Transition* transition) {
    const Body& body = scene.filter->state().body;
    predict_inertial(body, BodyLayout::with_inertial_unit(), scene.mounting,
                     preintegral_of(random_readings(random, 8), body), Scalar(9.81), transition);
  });
}

void test_samples_should_see_the_scale() {
  SeededRandom random(313);
  InertialScene scene(random);
  const Dense before = scene.filter.gauge().col(6);
  scene.filter.set_P(before * before.transpose());
  Transition transition;
  const Body& body = scene.filter->state().body;
  predict_inertial(body, BodyLayout::with_inertial_unit(), scene.mounting,
                   preintegral_of(random_readings(random, 8), body), Scalar(9.81), &transition);
  scene.filter->predict(transition);
  const Dense after = scene.filter.gauge().col(6);
  TEST_ASSERT_TRUE(largest(scene.filter.P() - after * after.transpose()) > 1e-3);
}

void test_samples_of_the_gyro_alone_should_carry_every_direction() {
  SeededRandom random(314);
  carries("predict_rotation_only", kAll, false, random, [&](InertialScene& scene, Transition* transition) {
    const Body& body = scene.filter->state().body;
    predict_rotation_only(body, BodyLayout::with_inertial_unit(), scene.mounting,
                          preintegral_of(random_readings(random, 8), body), Scalar(1), transition);
  });
}

void test_a_rest_should_carry_shifts_and_turns() {
  SeededRandom random(315);
  carries("begin_at_rest", kShiftAndTurn, true, random, [&](InertialScene& scene, Transition* transition) {
    RestReading rest;
    rest.accel = random.normals<3>(1) + Vec3(0, Scalar(-9.81), 0);
    rest.gravity = Scalar(9.81);
    begin_at_rest(scene.filter->state().body, BodyLayout::with_inertial_unit(), scene.mounting, rest, transition);
  });
}

/// The scale too where the unit is in the camera; beside it the curve of its arm is a length.
void test_a_body_without_samples_should_carry_every_direction() {
  SeededRandom random(317);
  const auto predict = [&](InertialScene& scene, Transition* transition) {
    predict_without_samples(scene.filter->state().body, BodyLayout::with_inertial_unit(), scene.mounting, Scalar(0.04),
                            {Scalar(1), Scalar(2)}, transition);
  };
  carries("predict_without_samples", kShiftAndTurn, true, random, predict);
  carries("predict_without_samples", kAll, false, random, predict);
}

int random_plane(SeededRandom& random, TestFilter& filter) {
  const PlaneFrame frame = {random_turn(random, 1.5).toRotationMatrix(), random.normals<3>(2)};
  const int plane = filter->add_known_plane(frame, Mat3::Identity(), Scalar(0));
  TEST_ASSERT_TRUE(plane >= 0);
  std::vector<Scalar> e(static_cast<std::size_t>(filter.dim()), Scalar(0));  // away from its frame
  for (int i = 0; i < 3; ++i) e[static_cast<std::size_t>(filter.first(plane) + i)] = random.normals<1>(0.3)(0);
  filter.move(e.data());
  return plane;
}

void test_no_vertical_plane_should_see_a_shift_a_turn_or_a_change_of_scale() {
  SeededRandom random(318);
  for (int trial = 0; trial < 10; ++trial) {
    InertialScene scene(random);
    const int plane = random_plane(random, scene.filter);
    scene.filter.set_unobservable(
        gauge::kBareCamera);  // the plane was known beforehand, but is a plane like any other here
    VerticalMeasurement z;
    predict_vertical(scene.filter->state(), plane, &z);
    const Dense H = dense_rows(*scene.filter, z.H), N = scene.filter.gauge();
    for (int c = 0; c < kAll; ++c)
      TEST_ASSERT_TRUE(largest(H * N.col(c)) < 1e-11 * (1 + largest(H) * largest(N.col(c))));
  }
}

/// A map of points, a plane and inverse depths that becomes metric: pixels stay where they were, the scale is as known as the start says,
/// together with gravity, and shifts and turns stay as open as they were. So do pixels of a rolling shutter, which see the camera's speed,
/// while the state's becomes that of the unit: with what is open of the rotation's rate.
void test_a_map_that_becomes_metric_should_look_the_same_and_know_its_scale() {
  SeededRandom random(319);
  for (int trial = 0; trial < 10; ++trial) {
    InertialScene scene(random);
    Mounting none = scene.mounting;
    none.p_C.setZero();
    none.in_metres = false;
    scene.filter->set_mounting(none);
    random_plane(random, scene.filter);
    scene.filter.set_P(random_covariance(random, scene.filter.dim(), 0.05));
    Camera rolling = pinhole_camera();
    rolling.readout = Scalar(0.03);
    std::vector<Vec2> before, rows_before;
    std::vector<Mat2> spread_before;
    for (const int slot : scene.slots) {
      PixelMeasurement o;
      TEST_ASSERT_TRUE(scene.filter->predict_pixel(pinhole_camera(), slot, &o));
      before.push_back(o.predicted);
      TEST_ASSERT_TRUE(scene.filter->predict_pixel(rolling, slot, &o));
      rows_before.push_back(o.predicted);
      spread_before.push_back(scene.filter->innovation(o));
    }
    MovingSolution start;
    start.scale = Scalar(2.5);
    start.q_WG = random_turn(random, 1);
    start.covariance = random_covariance(random, 6, 0.02).cast<Scalar>();
    scene.filter->set_metric(start, scene.mounting);
    TEST_ASSERT_TRUE(scene.filter->is_metric());
    for (std::size_t i = 0; i < scene.slots.size(); ++i) {
      PixelMeasurement o;
      TEST_ASSERT_TRUE(scene.filter->predict_pixel(pinhole_camera(), scene.slots[i], &o));
      TEST_ASSERT_TRUE((o.predicted - before[i]).norm() < Scalar(1e-6));
      TEST_ASSERT_TRUE(scene.filter->predict_pixel(rolling, scene.slots[i], &o));
      TEST_ASSERT_TRUE((o.predicted - rows_before[i]).norm() < Scalar(1e-6));
      const Mat2 more = scene.filter->innovation(o) - spread_before[i];
      TEST_ASSERT_TRUE(more.norm() < Scalar(1e-6) * spread_before[i].norm());
    }
    ScaleRow l;
    TEST_ASSERT_TRUE(scene.filter->scale_row(&l));
    const Dense P = scene.filter.P();
    const Eigen::SelfAdjointEigenSolver<Dense> eigen(P, Eigen::EigenvaluesOnly);
    TEST_ASSERT_TRUE(eigen.eigenvalues()(0) > -1e-12);
    const int gravity = scene.filter->state().layout.row(BodyPart::kGravity), accel = gravity - 3;
    for (int i = 0; i < 3; ++i)
      TEST_ASSERT_TRUE(std::abs(scene.filter->variance(accel + i) / start.covariance(3 + i, 3 + i) - 1) < Scalar(1e-6));
  }
}

void test_a_start_from_motion_should_hang_gravity_and_bias_on_the_rotation_that_its_poses_had() {
  SeededRandom random(339);
  for (int trial = 0; trial < 10; ++trial) {
    InertialScene scene(random);
    random_plane(random, scene.filter);
    scene.filter.set_P(random_covariance(random, scene.filter.dim(), 0.05));
    MovingSolution start;
    start.q_WG = random_turn(random, 1);
    start.by_turn = Eigen::Matrix<double, 6, 3>(0.5 * Eigen::Matrix<double, 6, 3>::Ones()).cast<Scalar>();
    start.by_turn.row(4) = random.normals<3>(10).cast<Scalar>();
    start.span = Scalar(3);
    Scalar theta = 0;
    for (int i = 0; i < 3; ++i) theta += scene.filter->variance(Body::kTheta + i) / 3;
    start.turn_variance = theta / (start.span * start.span);  // theta is rho T
    start.covariance = random_covariance(random, 6, 0.02).cast<Scalar>();
    start.covariance += start.turn_variance * start.by_turn * start.by_turn.transpose();
    const Dense before = scene.filter.P();
    scene.filter->set_metric(start, scene.mounting);
    const Dense P = scene.filter.P();
    TEST_ASSERT_TRUE(Eigen::SelfAdjointEigenSolver<Dense>(P, Eigen::EigenvaluesOnly).eigenvalues()(0) > -1e-12);
    const int gravity = scene.filter->state().layout.row(BodyPart::kGravity), accel = gravity - 3;
    const Dense J = start.by_turn.cast<double>() / static_cast<double>(start.span);
    const Dense E_t = start.q_WG.toRotationMatrix().leftCols<2>().transpose().cast<double>();
    const Dense of_theta = before.block(Body::kTheta, Body::kTheta, 3, 3);
    // Nothing of theta is scale, so what the scale is replaced by changes none of this.
    const Dense of_bias = P.block(accel, Body::kTheta, 3, 3) - J.bottomRows(3) * of_theta;
    const Dense of_gravity = P.block(gravity, Body::kTheta, 2, 3) - (E_t / 2 + J.middleRows(1, 2)) * of_theta;
    TEST_ASSERT_TRUE(of_bias.norm() < 1e-9 && of_gravity.norm() < 1e-9);
  }
}

double information_growth(bool keep_gauge) {
  SeededRandom random(316);
  double growth = 0;
  for (int trial = 0; trial < 10; ++trial) {
    InertialScene scene(random);
    scene.filter->keep_gauge(keep_gauge);
    const Dense N = scene.filter.gauge();
    const Dense A = random_covariance(random, kAll, 0.3);
    scene.filter.set_P(N * A * N.transpose() + random_covariance(random, scene.filter.dim(), 0.02));
    const Dense before = scene.filter.gauge_information();
    std::vector<PixelMeasurement> seen;
    for (const int slot : scene.slots) {
      PixelMeasurement o;
      TEST_ASSERT_TRUE(scene.filter->predict_pixel(pinhole_camera(), slot, &o));
      o.measured = o.predicted + random.normals<2>(3);
      o.set_noise(Mat2::Identity());
      seen.push_back(o);
      if (seen.size() == 6) break;
    }
    scene.filter->begin_update(seen.data(), static_cast<int>(seen.size()));
    TEST_ASSERT_TRUE(scene.filter->finish_update(seen.data(), static_cast<int>(seen.size()), nullptr, nullptr));
    const Dense now = scene.filter.gauge_information();
    for (int i = 0; i < kAll; ++i) growth = std::max(growth, now(i, i) / before(i, i) - 1);
  }
  return growth;
}

void test_pixels_should_gain_nothing_about_the_gauge() {
  TEST_ASSERT_TRUE(information_growth(true) < 1e-9);
  TEST_ASSERT_TRUE(information_growth(false) > 1e-3);
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_no_pixel_should_see_a_shift_a_turn_or_a_change_of_scale);
  RUN_TEST(test_samples_should_carry_shifts_and_turns);
  RUN_TEST(test_samples_should_see_the_scale);
  RUN_TEST(test_samples_of_the_gyro_alone_should_carry_every_direction);
  RUN_TEST(test_a_rest_should_carry_shifts_and_turns);
  RUN_TEST(test_a_body_without_samples_should_carry_every_direction);
  RUN_TEST(test_no_vertical_plane_should_see_a_shift_a_turn_or_a_change_of_scale);
  RUN_TEST(test_a_map_that_becomes_metric_should_look_the_same_and_know_its_scale);
  RUN_TEST(test_pixels_should_gain_nothing_about_the_gauge);
  RUN_TEST(test_a_start_from_motion_should_hang_gravity_and_bias_on_the_rotation_that_its_poses_had);
  return UNITY_END();
}
