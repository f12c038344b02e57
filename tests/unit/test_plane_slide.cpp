// A plane that moves with its points along their rays: pixels stay, and the covariance grows by what differences of the move itself say.
#include <memory>

#include "model/camera_at.h"
#include "support/plane_scene.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

const Vec3 kMove(Scalar(0.04), Scalar(-0.03), Scalar(0.02));

std::unique_ptr<PlaneScene> folded_scene() {
  SeededRandom random(61);
  auto scene = std::make_unique<PlaneScene>(random, 0.001, false);
  TEST_ASSERT_EQUAL_INT(8, scene->fold_all(PlaneScene::drop()));
  return scene;
}

Vec2 pixel_of(const TestFilter& filter, int slot) {
  const CameraAt camera = camera_at((*filter).state(), Scalar(0));
  Vec2 z;
  TEST_ASSERT_TRUE(project(pinhole_camera(), Vec3(camera.q_WC.conjugate() * ((*filter).point(slot) - camera.p_W)), &z));
  return z;
}

void test_points_should_follow_their_plane_along_their_rays() {
  const auto scene = folded_scene();
  std::vector<Vec2> before;
  for (const int slot : scene->on_wall) before.push_back(pixel_of(scene->filter, slot));
  const Vec3 x = scene->filter->state().block[scene->plane].xyz() + kMove;
  TEST_ASSERT_TRUE(scene->filter->slide_plane(scene->plane, x, Mat3(Mat3::Identity() * Scalar(1e-4)), Scalar(0)));
  const Block& plane = scene->filter->state().block[scene->plane];
  TEST_ASSERT_TRUE((plane.xyz() - x).norm() < 1e-12);
  for (std::size_t i = 0; i < before.size(); ++i) {
    TEST_ASSERT_TRUE((pixel_of(scene->filter, scene->on_wall[i]) - before[i]).norm() < 1e-6);
    const Vec3 p_W = scene->filter->point(scene->on_wall[i]);
    TEST_ASSERT_TRUE(std::abs(plane_distance(scene->filter->state().frame_of(plane), x, p_W)) < 1e-9);
  }
}

void test_covariance_should_grow_by_how_points_follow() {
  SeededRandom random(62);
  const auto nominal = folded_scene();
  const Vec3 x = nominal->filter->state().block[nominal->plane].xyz() + kMove;
  const Mat3 Q = random_covariance(random, 3, 0.01).cast<Scalar>();
  constexpr double kOwn = 0.002, kStep = 1e-6;
  const int n = nominal->filter.dim();
  Dense F = Dense::Zero(n, 3);
  for (int j = 0; j < 3; ++j) {
    Eigen::VectorXd at[2];
    for (int side = 0; side < 2; ++side) {
      const auto scene = folded_scene();
      const Vec3 moved = x + Vec3::Unit(j) * static_cast<Scalar>(side == 0 ? kStep : -kStep);
      TEST_ASSERT_TRUE(scene->filter->slide_plane(scene->plane, moved, Q, Scalar(0)));
      at[side] = coordinates(scene->filter);
    }
    F.col(j) = (at[0] - at[1]) / (2 * kStep);
  }
  Dense expected = nominal->filter.P() + F * Q.cast<double>() * F.transpose();
  for (const int slot : nominal->on_wall)
    for (int i = 0; i < 2; ++i)
      expected(nominal->filter.first(slot) + i, nominal->filter.first(slot) + i) += kOwn * kOwn;
  TEST_ASSERT_TRUE(nominal->filter->slide_plane(nominal->plane, x, Q, static_cast<Scalar>(kOwn)));
  TEST_ASSERT_TRUE(difference(nominal->filter.P(), expected) < 1e-6);
}

void test_nothing_should_change_where_the_covariance_is_none() {
  const auto scene = folded_scene();
  const std::vector<Scalar> before = bits_of(scene->filter);
  Mat3 Q = Mat3::Identity();
  Q(1, 1) = -1;
  TEST_ASSERT_FALSE(scene->filter->slide_plane(scene->plane, kMove, Q, Scalar(0)));
  const std::vector<Scalar> after = bits_of(scene->filter);
  TEST_ASSERT_EQUAL_MEMORY(before.data(), after.data(), before.size() * sizeof(Scalar));
}

void test_a_point_should_leave_along_its_ray() {
  const auto scene = folded_scene(), plain = folded_scene();
  const int slot = scene->on_wall[2];
  const Vec2 before = pixel_of(scene->filter, slot);
  const Vec3 from = scene->filter->point(slot), ray = (from - scene->filter->state().body.p_W).normalized();
  constexpr double kAlong = -0.05, kSigma = 0.02;
  TEST_ASSERT_TRUE(scene->filter->unfold_along(slot, Scalar(kAlong), Scalar(kSigma)));
  TEST_ASSERT_TRUE(plain->filter->unfold(slot, Scalar(0)));
  TEST_ASSERT_TRUE((pixel_of(scene->filter, slot) - before).norm() < 1e-6);
  TEST_ASSERT_TRUE((scene->filter->point(slot) - (from + Scalar(kAlong) * ray)).norm() < 1e-9);
  Dense expected = plain->filter.P();
  const Eigen::Vector3d d = ray.cast<double>();
  expected.block<3, 3>(plain->filter.first(slot), plain->filter.first(slot)) += kSigma * kSigma * d * d.transpose();
  TEST_ASSERT_TRUE(difference(scene->filter.P(), expected) < 1e-4);
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_points_should_follow_their_plane_along_their_rays);
  RUN_TEST(test_covariance_should_grow_by_how_points_follow);
  RUN_TEST(test_nothing_should_change_where_the_covariance_is_none);
  RUN_TEST(test_a_point_should_leave_along_its_ray);
  return UNITY_END();
}
