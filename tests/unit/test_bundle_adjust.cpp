// The bundle adjuster against dense normal equations, and on scenes whose truth is known.
#include <algorithm>
#include <cmath>
#include <vector>

#include "bundle/bundle_adjuster.h"
#include "geometry/so3.h"
#include "same.h"
#include "support/bounds.h"
#include "support/filter_cases.h"
#include "support/seeded_random.h"
#include "support/test_cameras.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr int kPoses = 5, kPoints = 24;
constexpr bool kIsFloat = sizeof(Scalar) == 4;

/// Two fixed poses and three free ones before a cloud of points; every third point has a free pose as host.
struct Scene {
  TestArena arena;
  BundleAdjuster adjuster;
  Camera camera = test_camera_of(1);
  AdjustOptions options = {Scalar(0.5), Scalar(3), Scalar(0.5), Scalar(2), Scalar(10), Scalar(100), 30};
  BundlePose pose[kPoses], truth[kPoses];
  BundlePixel pixel[kPoses][kPoints];
  Vec3 ray[kPoints];
  int host[kPoints];
  Scalar rho[kPoints], true_rho[kPoints];
  Bundle bundle = {pose, kPoses, ray, host, rho, kPoints};

  explicit Scene(SeededRandom& random, double noise_px) {
    TEST_ASSERT_TRUE(adjuster.layout(*arena, kPoses, 3, kPoints));
    for (int c = 0; c < kPoses; ++c) {
      truth[c] = {exp_so3(random.normals<3>(0.03)), Vec3::Zero(), c != 0 && c != 3, pixel[c]};
      truth[c].p_W = Vec3(static_cast<Scalar>(0.15 * c), 0, 0) + random.normals<3>(0.05);
    }
    for (int i = 0; i < kPoints; ++i) {
      host[i] = i % 3 == 0 ? 4 - i % 2 * 3 : 0;
      const double depth = random.uniform(1.5, 4);
      const double x = depth * random.uniform(-0.25, 0.25), y = depth * random.uniform(-0.2, 0.2);
      const Vec3 p_W(static_cast<Scalar>(x), static_cast<Scalar>(y), static_cast<Scalar>(depth));
      const BundlePose& h = truth[host[i]];
      const Vec3 d = h.q_WC.conjugate() * (p_W - h.p_W);
      ray[i] = d.normalized();
      true_rho[i] = rho[i] = Scalar(1) / d.norm();
      for (int c = 0; c < kPoses; ++c) {
        Vec2 z;
        pixel[c][i].seen =
            project(camera, truth[c].q_WC.conjugate() * (p_W - truth[c].p_W), &z) && random.uniform(0, 1) < 0.9;
        if (!pixel[c][i].seen) continue;
        z += random.normals<2>(noise_px);
        pixel[c][i].x = static_cast<float>(z.x());
        pixel[c][i].y = static_cast<float>(z.y());
      }
    }
    std::copy(truth, truth + kPoses, pose);
  }

  void disturb(SeededRandom& random, double pose_sigma, double rho_sigma) {
    for (BundlePose& p : pose) {
      if (!p.free) continue;
      p.q_WC = exp_so3(random.normals<3>(pose_sigma)) * p.q_WC;
      p.p_W += random.normals<3>(pose_sigma);
    }
    for (Scalar& r : rho) r *= static_cast<Scalar>(1 + random.uniform(-rho_sigma, rho_sigma));
  }

  /// J, weights and residuals of every pixel and prior as one dense system, in double: (free poses, rho).
  void dense(Dense* H, Eigen::VectorXd* g) const {
    const int n = 18 + kPoints;
    *H = Dense::Zero(n, n);
    *g = Eigen::VectorXd::Zero(n);
    int column[kPoses], columns = 0;
    for (int c = 0; c < kPoses; ++c) column[c] = pose[c].free ? 6 * columns++ : -1;
    for (int c = 0; c < kPoses; ++c) {
      for (int i = 0; i < kPoints; ++i) {
        if (!pixel[c][i].seen || host[i] == c) continue;
        Vec2 z, J_rho;
        Mat26 J_C, J_H;
        const Vec3 ray_W = pose[host[i]].q_WC.toRotationMatrix() * ray[i];
        TEST_ASSERT_TRUE(project_bearing(camera, pose[c].q_WC.toRotationMatrix(), ray_W,
                                         pose[host[i]].p_W - pose[c].p_W, rho[i], &z, &J_C, &J_H, &J_rho));
        Dense J = Dense::Zero(2, n);
        if (column[c] >= 0) J.middleCols(column[c], 6) += J_C.cast<double>();
        if (column[host[i]] >= 0) J.middleCols(column[host[i]], 6) += J_H.cast<double>();
        J.col(18 + i) = J_rho.cast<double>();
        const Eigen::Vector2d r = (pixel[c][i].pixel() - z).cast<double>();
        const double information = 1 / static_cast<double>(options.sigma_px * options.sigma_px);
        const double sigmas = std::sqrt(r.squaredNorm() * information);
        const double weight =
            information *
            (sigmas > static_cast<double>(options.huber) ? static_cast<double>(options.huber) / sigmas : 1);
        *H += weight * J.transpose() * J;
        *g += weight * J.transpose() * r;
      }
    }
    for (int i = 0; i < kPoints; ++i) {
      const double prior = 1 / static_cast<double>(options.rho_sigma * options.rho_sigma);
      (*H)(18 + i, 18 + i) += prior;
      (*g)(18 + i) += prior * static_cast<double>(options.rho_mean - rho[i]);
    }
  }
};

/// The damped step by the definition in normal_equations.h, from the dense system.
Eigen::VectorXd dense_step(Dense H, const Eigen::VectorXd& g, double damping) {
  const int points = static_cast<int>(H.rows()) - 18;
  for (int i = 18; i < H.rows(); ++i) H(i, i) *= 1 + damping;
  const Dense W = H.topRightCorner(18, points), D = H.bottomRightCorner(points, points);
  Dense S = H.topLeftCorner(18, 18) - W * inverse_of(D) * W.transpose();
  for (int i = 0; i < 18; ++i) S(i, i) += damping * std::fabs(S(i, i)) + 1e-9;
  Eigen::VectorXd x(H.rows());
  x.head(18) = solved(S, g.head(18) - W * inverse_of(D) * g.tail(points));
  x.tail(points) = inverse_of(D) * (g.tail(points) - W.transpose() * x.head(18));
  return x;
}

void test_step_should_be_that_of_the_dense_normal_equations() {
  SeededRandom random(51);
  for (const double damping : {0.0, 1e-3, 0.5, 20.0}) {
    Scene scene(random, 0.5);
    scene.disturb(random, 0.02, 0.2);
    scene.pixel[2][5].x += 30;  // beyond the Huber bound
    Dense H;
    Eigen::VectorXd g;
    scene.dense(&H, &g);
    const Eigen::VectorXd expected = dense_step(H, g, damping);
    TEST_ASSERT_TRUE(scene.adjuster.step(scene.camera, scene.options, scene.bundle, static_cast<Scalar>(damping)));
    double worst = 0;
    for (int a = 0; a < 18; ++a)
      worst = std::max(worst, std::fabs(static_cast<double>(scene.adjuster.pose_step()[a]) - expected(a)));
    for (int i = 0; i < kPoints; ++i)
      worst = std::max(worst, std::fabs(static_cast<double>(scene.adjuster.rho_step(i)) - expected(18 + i)));
    std::printf("damping %g: steps up to %.3g, difference %.3g\n", damping, expected.cwiseAbs().maxCoeff(), worst);
    EXPECT_BELOW((kIsFloat ? 1e-3 : 1e-9) * expected.cwiseAbs().maxCoeff(), worst);
  }
}

void test_covariance_of_the_last_pose_should_be_that_of_the_dense_inverse() {
  SeededRandom random(52);
  Scene scene(random, 0.3);
  Dense H;
  Eigen::VectorXd g;
  scene.dense(&H, &g);
  const Dense expected = inverse_of(H).block(12, 12, 6, 6);
  Mat6 covariance;
  TEST_ASSERT_TRUE(scene.adjuster.last_pose_covariance(scene.camera, scene.options, scene.bundle, &covariance));
  for (int a = 0; a < 6; ++a)
    for (int b = 0; b < 6; ++b)
      EXPECT_BELOW((kIsFloat ? 2e-2 : 1e-8) * std::sqrt(expected(a, a) * expected(b, b)),
                   std::fabs(static_cast<double>(covariance(a, b)) - expected(a, b)));
}

void test_covariance_should_be_refused_when_nothing_is_free_or_a_pose_sees_nothing() {
  SeededRandom random(53);
  Scene scene(random, 0);
  Mat6 covariance;
  for (BundlePixel& p : scene.pixel[4]) p.seen = false;
  for (int& h : scene.host) h = 0;
  TEST_ASSERT_FALSE(scene.adjuster.last_pose_covariance(scene.camera, scene.options, scene.bundle, &covariance));
  for (BundlePose& p : scene.pose) p.free = false;
  TEST_ASSERT_FALSE(scene.adjuster.last_pose_covariance(scene.camera, scene.options, scene.bundle, &covariance));
}

/// Nothing but the distance, in whose direction the error is linear: a few steps are enough, the first of them damped.
void test_held_distance_should_bring_a_pose_there() {
  SeededRandom random(77);
  Scene scene(random, 0);
  const Vec3 from_W(Scalar(0.2), Scalar(-0.1), Scalar(0.3)), along = Vec3(2, -1, 2).normalized();
  BundlePose pose = {Quat::Identity(), from_W + Scalar(0.5) * along, true, nullptr};
  const BundleDistance held = {0, from_W, Scalar(0.6), Scalar(0.01)};
  Bundle bundle = {&pose, 1, scene.ray, nullptr, scene.rho, 0};
  bundle.held = &held;
  scene.options.max_rounds = 0;
  TEST_ASSERT_DOUBLE_WITHIN(1e-3, 100, static_cast<double>(scene.adjuster.adjust(scene.camera, scene.options, bundle)));
  scene.options.max_rounds = 4;
  EXPECT_BELOW(1e-4, static_cast<double>(scene.adjuster.adjust(scene.camera, scene.options, bundle)));
  EXPECT_BELOW(1e-4, std::fabs(static_cast<double>((pose.p_W - from_W).norm()) - 0.6));
}

/// With the pixels of a scene whose scale nothing else holds, the distance stays, and everything comes to the truth in its unit.
void test_held_distance_should_hold_the_scale() {
  SeededRandom random(78);
  Scene scene(random, 0);
  const Scalar wanted = Scalar(1.02) * (scene.truth[4].p_W - scene.truth[0].p_W).norm();
  const BundleDistance held = {4, scene.truth[0].p_W, wanted, Scalar(1e-4) * wanted};
  for (int c = 0; c < kPoses; ++c) {
    scene.pose[c] = scene.truth[c];
    scene.pose[c].free = c == 1 || c == 2 || c == 4;
  }
  std::copy(scene.true_rho, scene.true_rho + kPoints, scene.rho);
  scene.pose[3].pixel = nullptr;  // fixed where it is, it would hold the scale
  for (int i = 0; i < kPoints; ++i) scene.host[i] = 0;
  for (int i = 0; i < kPoints; ++i) {
    const BundlePose& h = scene.truth[i % 3 == 0 ? 4 - i % 2 * 3 : 0];
    const Vec3 p_W = h.p_W + h.q_WC * (scene.ray[i] / scene.true_rho[i]);
    const Vec3 d = scene.truth[0].q_WC.conjugate() * (p_W - scene.truth[0].p_W);
    scene.ray[i] = d.normalized();
    scene.rho[i] = Scalar(1) / d.norm();
  }
  scene.options.rho_sigma = 0;
  scene.options.small_gain = Scalar(1e-9);
  scene.bundle.held = &held;
  scene.adjuster.adjust(scene.camera, scene.options, scene.bundle);
  for (const int c : {1, 2, 4}) {
    const Vec3 scaled = scene.truth[0].p_W + Scalar(1.02) * (scene.truth[c].p_W - scene.truth[0].p_W);
    EXPECT_BELOW(1e-3, static_cast<double>((scene.pose[c].p_W - scaled).norm()));
  }
}

void test_adjusting_should_find_the_truth_and_leave_fixed_poses_when_pixels_are_exact() {
  SeededRandom random(54);
  for (int trial = 0; trial < 5; ++trial) {
    Scene scene(random, 0);
    scene.options.rho_sigma = 100;  // hardly a prior
    scene.disturb(random, 0.02, 0.2);
    const Vec3 fixed = scene.pose[3].p_W;
    const Scalar cost = scene.adjuster.adjust(scene.camera, scene.options, scene.bundle);
    EXPECT_BELOW(0.01, cost);
    for (int c = 0; c < kPoses; ++c) {
      EXPECT_BELOW(1e-3, static_cast<double>((scene.pose[c].p_W - scene.truth[c].p_W).norm()));
      EXPECT_BELOW(1e-3, static_cast<double>(scene.pose[c].q_WC.angularDistance(scene.truth[c].q_WC)));
    }
    TEST_ASSERT_SAME(fixed, scene.pose[3].p_W);
    for (int i = 0; i < kPoints; ++i)
      EXPECT_BELOW(5e-3, std::fabs(static_cast<double>(scene.rho[i] / scene.true_rho[i] - 1)));
  }
}

void test_adjusting_should_never_raise_the_cost_and_stop_after_its_rounds() {
  SeededRandom random(55);
  Scene scene(random, 0.5);
  scene.disturb(random, 0.1, 0.5);
  scene.options.max_rounds = 0;
  Scalar last = scene.adjuster.adjust(scene.camera, scene.options, scene.bundle);
  scene.options.max_rounds = 1;
  for (int round = 0; round < 20; ++round) {
    const Scalar now = scene.adjuster.adjust(scene.camera, scene.options, scene.bundle);
    TEST_ASSERT_TRUE(now <= last);
    last = now;
  }
}

void test_more_poses_than_a_mask_has_bits_should_be_refused() {
  TestArena arena;
  BundleAdjuster adjuster;
  TEST_ASSERT_FALSE(adjuster.layout(*arena, BundleAdjuster::kMaxPoses + 1, 3, kPoints));
  TEST_ASSERT_TRUE(adjuster.layout(*arena, BundleAdjuster::kMaxPoses, 3, kPoints));
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_step_should_be_that_of_the_dense_normal_equations);
  RUN_TEST(test_covariance_of_the_last_pose_should_be_that_of_the_dense_inverse);
  RUN_TEST(test_covariance_should_be_refused_when_nothing_is_free_or_a_pose_sees_nothing);
  RUN_TEST(test_held_distance_should_bring_a_pose_there);
  RUN_TEST(test_held_distance_should_hold_the_scale);
  RUN_TEST(test_adjusting_should_find_the_truth_and_leave_fixed_poses_when_pixels_are_exact);
  RUN_TEST(test_adjusting_should_never_raise_the_cost_and_stop_after_its_rounds);
  RUN_TEST(test_more_poses_than_a_mask_has_bits_should_be_refused);
  return UNITY_END();
}
