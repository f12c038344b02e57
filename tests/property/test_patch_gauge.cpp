// Patches of walls alone: where no point of the map gives a length, updates still gain nothing about the world's place, rotation and scale.
#include "filter/gauge_information.h"
#include "geometry/ray_plane.h"
#include "same.h"
#include "support/filter_cases.h"
#include "support/test_cameras.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr int kAll = 7, kPatches = 3, kFrames = 60;
constexpr Scalar kDistance = 5, kHalfSide = 40, kSigma = Scalar(0.1);

/// A wall that faces the camera, and is wrong by an angle about the vertical [rad] and along its normal [m].
PlaneFrame wall_at(Scalar angle, Scalar offset) {
  PlaneFrame frame;
  frame.R_WP = exp_so3(Vec3(0, angle, 0)).toRotationMatrix() * Vec3(1, -1, -1).asDiagonal();
  frame.o_W = Vec3(0, 0, kDistance) + offset * frame.R_WP.col(2);
  return frame;
}

/// Where the true camera sees what the first camera saw at a pixel of the true wall.
bool see(const Camera& camera, const Body& first, const Body& truth, const Vec2& pixel, Vec2* z) {
  Vec3 ray, hit_W;
  return unproject(camera, pixel, &ray) &&
         intersect_ray_plane(wall_at(0, 0), Vec3::Zero(), first.p_W, first.q_WC * ray, &hit_W) &&
         project(camera, Vec3(truth.q_WC.conjugate() * (hit_W - truth.p_W)), z);
}

/// Largest growth of the information about each direction in one frame, relative to what there was.
Eigen::Matrix<double, kAll, 1> largest_growth(bool keep_gauge, SeededRandom& random) {
  const Camera camera = pinhole_camera();
  TestFilter filter(keep_gauge, BodyLayout::with_constant_velocity(), 96, 8);
  const Body first;
  Body truth = first;
  filter->set_mean(first);
  filter.set_P(Eigen::VectorXd::Constant(kBodyRows, 1e-4).asDiagonal());
  Mat3 C = Mat3::Zero();
  C.diagonal() = Vec3(Scalar(3e-3), Scalar(3e-4), Scalar(0.04));
  const int wall = filter->add_known_plane(wall_at(Scalar(0.05), Scalar(0.2)), C, Scalar(0.002));
  const int reference = filter->add_reference_camera();
  filter->pin(reference);
  Vec2 corner[kPatches][4];
  int slot[kPatches];
  for (int i = 0; i < kPatches; ++i) {
    const Vec2 middle(camera.cx + Scalar(120 * (i - 1)), camera.cy + Scalar(30 * i));
    for (int k = 0; k < 4; ++k) corner[i][k] = middle + kHalfSide * Vec2(k == 1 || k == 2 ? 1 : -1, k >= 2 ? 1 : -1);
    slot[i] = filter->add_patch(reference, kSigma * kSigma * PatchMeasurement::Matrix::Identity());
    TEST_ASSERT_TRUE(slot[i] >= 0);
  }

  constexpr Scalar dt = Scalar(1) / 30;
  Eigen::Matrix<double, kAll, 1> growth = Eigen::Matrix<double, kAll, 1>::Zero();
  int measured = 0;
  for (int frame = 0; frame < kFrames; ++frame) {
    truth.v_W = Vec3(Scalar(0.5), Scalar(0.2) * std::sin(Scalar(frame) / 9), Scalar(0.1));
    truth.w_C = Vec3(Scalar(0.05), Scalar(-0.1) * std::cos(Scalar(frame) / 11), Scalar(0.02));
    Transition transition;
    predict_constant_velocity(truth, BodyLayout::with_constant_velocity(), dt, {}, &transition);
    truth = transition.mean;
    predict_constant_velocity(filter->state().body, BodyLayout::with_constant_velocity(), dt, {Scalar(1), Scalar(2)},
                              &transition);
    filter->predict(transition);
    const Dense before = filter.gauge_information();
    for (int i = 0; i < kPatches; ++i) {
      PatchMeasurement z;
      Vec2 seen[4];
      bool in_view = filter->predict_patch(camera, slot[i], wall, corner[i], &z);
      for (int k = 0; k < 4; ++k) in_view = in_view && see(camera, first, truth, corner[i][k], &seen[k]);
      if (!in_view) continue;
      for (int k = 0; k < 4; ++k)
        z.measured.segment<2>(2 * k) = seen[k] + random.normals<2>(static_cast<double>(kSigma));
      z.set_noise(kSigma * kSigma * PatchMeasurement::Matrix::Identity());
      const Measurement view = z.view();
      filter->begin_update(&view, 1);
      TEST_ASSERT_TRUE(filter->finish_update(&view, 1, nullptr, nullptr));
      ++measured;
    }
    const Dense now = filter.gauge_information();
    for (int i = 0; i < kAll; ++i) growth(i) = std::max(growth(i), now(i, i) / before(i, i) - 1);
  }
  TEST_ASSERT_GREATER_THAN_INT(kPatches * kFrames / 2, measured);
  return growth;
}

void test_patches_alone_should_gain_nothing_about_the_gauge() {
  SeededRandom random(91);
  for (int trial = 0; trial < 5; ++trial) {
    const auto growth = largest_growth(true, random);
    for (int i = 0; i < kAll; ++i) {
      if (!(growth(i) < 1e-9)) std::printf("direction %d: %.3g in one frame\n", i, growth(i));
      TEST_ASSERT_TRUE(growth(i) < 1e-9);
    }
  }
}

void test_patches_alone_should_gain_on_the_scale_with_the_textbook_filter() {
  SeededRandom random(92);
  TEST_ASSERT_TRUE(largest_growth(false, random)(kAll - 1) > 1e-6);
}

/// The row that stands for the log scale there: it grows with the world, and is the same wherever the world is and however it is turned.
void test_the_row_of_the_scale_should_be_a_length_without_points() {
  SeededRandom random(93);
  for (int trial = 0; trial < 10; ++trial) {
    TestFilter filter(true);
    filter->set_mean(random_body(random));
    filter.set_P(Eigen::VectorXd::Constant(kBodyRows, 1e-4).asDiagonal());
    ScaleRow l;
    TEST_ASSERT_FALSE(filter->scale_row(&l));
    PlaneFrame frame = wall_at(Scalar(0.3), Scalar(1));
    frame.o_W += random.normals<3>(0.3);
    TEST_ASSERT_TRUE(filter->add_known_plane(frame, Mat3::Identity() * Scalar(0.01), Scalar(0.002)) >= 0);
    TEST_ASSERT_TRUE(filter->scale_row(&l));
    const Dense lN = dense_rows(*filter, l.view()) * filter.gauge();
    for (int i = 0; i < kAll; ++i) TEST_ASSERT_TRUE(std::abs(lN(0, i) - (i == kAll - 1 ? 1 : 0)) < 1e-12);
  }
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_patches_alone_should_gain_nothing_about_the_gauge);
  RUN_TEST(test_patches_alone_should_gain_on_the_scale_with_the_textbook_filter);
  RUN_TEST(test_the_row_of_the_scale_should_be_a_length_without_points);
  return UNITY_END();
}
