// An update that is linearised at another pose than the estimate, where the innovation is large: the pose's prior says nothing about the
// gauge there either.
#include "geometry/so3.h"
#include "support/plane_scene.h"
#include "support/test_cameras.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr int kAll = 7;

/// The pose of a camera that was predicted wrongly by some degrees and decimetres.
Body far_from(const Body& estimate, double angle, double way) {
  Body near = estimate;
  near.q_WC = exp_so3(Vec3(Scalar(0.4 * angle), Scalar(-0.6 * angle), Scalar(0.2 * angle))) * estimate.q_WC;
  near.p_W += Vec3(Scalar(0.7 * way), Scalar(-0.5 * way), Scalar(0.4 * way));
  return near;
}

/// The pixel of a point, linearised at near and predicted for the estimate. False where it does not project.
bool predict_near(TestFilter& filter, int slot, const Body& near, PixelMeasurement* z) {
  const Body estimate = filter->state().body;
  filter->set_mean(near);
  const bool ok = filter->predict_pixel(test_camera_of(0), slot, z);
  filter->set_mean(estimate);
  if (!ok) return false;
  Vec6 e;
  e << log_so3(estimate.q_WC * near.q_WC.conjugate()), estimate.p_W - near.p_W;
  z->measured = z->predicted + Vec2(Scalar(0.3), Scalar(-0.2));
  const int columns = z->H.columns();
  for (int r = 0; r < 2; ++r)
    for (int c = 0; c < 6; ++c) z->predicted(r) += z->H.h[r * columns + c] * e(c);
  z->set_noise(Mat2::Identity() * Scalar(0.01));
  return true;
}

/// A covariance of the gauge with some of all else, and a pose that is known against it to some degrees and decimetres.
void spread(PlaneScene& scene, SeededRandom& random) {
  const Dense N = scene.filter.gauge();
  Dense P =
      N * random_covariance(random, kAll, 0.3) * N.transpose() + random_covariance(random, scene.filter.dim(), 0.01);
  for (int i = 0; i < 6; ++i) P(i, i) += 0.04;
  scene.filter.set_P(P);
}

/// Largest relative growth of the information about a direction over some points' updates.
template <typename Update>
double growth_over(SeededRandom& random, Update update) {
  double worst = 0;
  for (int trial = 0; trial < 10; ++trial) {
    PlaneScene scene(random, 0.01);
    spread(scene, random);
    const Body near = far_from(scene.filter->state().body, 0.15, 0.3);
    for (const int slot : scene.on_wall) {
      PixelMeasurement z;
      if (!predict_near(scene.filter, slot, near, &z)) continue;
      const Dense before = scene.filter.gauge_information();
      update(scene.filter, z, near);
      const Dense now = scene.filter.gauge_information();
      for (int i = 0; i < kAll; ++i) worst = std::max(worst, (now(i, i) - before(i, i)) / before(i, i));
      break;
    }
  }
  return worst;
}

void test_an_update_near_another_pose_should_gain_nothing_about_the_gauge() {
  SeededRandom random(91);
  const double grown = growth_over(random, [](TestFilter& filter, const PixelMeasurement& z, const Body& near) {
    TEST_ASSERT_TRUE(filter->finish_update_near(z.view(), near, nullptr));
  });
  std::printf("largest growth: %.3g\n", grown);
  TEST_ASSERT_TRUE(grown < 1e-9);
}

/// What it is there for: the same measurement as if it were linearised at the estimate.
void test_an_update_with_a_jacobian_of_elsewhere_should_gain_some() {
  SeededRandom random(91);
  const double grown = growth_over(random, [](TestFilter& filter, const PixelMeasurement& z, const Body&) {
    const Measurement view = z.view();
    filter->begin_update(&view, 1);
    TEST_ASSERT_TRUE(filter->finish_update(&view, 1, nullptr, nullptr));
  });
  std::printf("largest growth: %.3g\n", grown);
  TEST_ASSERT_TRUE(grown > 1e-3);
}

/// At the estimate itself, both are the same.
void test_an_update_near_the_estimate_should_be_the_plain_one() {
  SeededRandom random(92), again(92);
  PlaneScene a(random, 0.01), b(again, 0.01);
  spread(a, random);
  spread(b, again);
  const Body estimate = a.filter->state().body;
  PixelMeasurement z;
  TEST_ASSERT_TRUE(predict_near(a.filter, a.on_wall[0], estimate, &z));
  const Measurement view = z.view();
  Scalar nis_a = 0, nis_b = 0;
  TEST_ASSERT_TRUE(a.filter->finish_update_near(view, estimate, &nis_a));
  b.filter->begin_update(&view, 1);
  TEST_ASSERT_TRUE(b.filter->finish_update(&view, 1, nullptr, &nis_b));
  TEST_ASSERT_TRUE(std::abs(nis_a - nis_b) < Scalar(1e-9) * nis_b);
  TEST_ASSERT_TRUE(largest(a.filter.P() - b.filter.P()) < 1e-12 * largest(b.filter.P()));
  TEST_ASSERT_TRUE((coordinates(a.filter) - coordinates(b.filter)).norm() < 1e-12);
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_an_update_near_another_pose_should_gain_nothing_about_the_gauge);
  RUN_TEST(test_an_update_with_a_jacobian_of_elsewhere_should_gain_some);
  RUN_TEST(test_an_update_near_the_estimate_should_be_the_plain_one);
  return UNITY_END();
}
