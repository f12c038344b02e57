// Where the map of the window is in W, by the walls of a plan.
#include <unity.h>

#include "geometry/so3.h"
#include "keyframe_slam/walls/wall_gauge.h"
#include "support/seeded_random.h"
#include "support/textured_images.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr int kWalls = 3;
constexpr Scalar kGate = Scalar(16.3);

/// Three walls at right angles about W, as a plan has them, and where they are.
struct Bench {
  SeededRandom random;
  TestArena arena;
  WallGauge gauge;
  PlaneFrame plan[kWalls];
  Mat3 prior;
  Vec3 truth[kWalls];  ///< (a, b, h) about the plan
  Vec3 first_W{Scalar(0.4), Scalar(-0.2), Scalar(0.3)};
  Mat6 pose = Mat6::Zero();
  Scalar sigma_scale = Scalar(0.05);

  explicit Bench(std::uint64_t seed) : random(seed) {
    TEST_ASSERT_TRUE(gauge.layout(*arena, kWalls));
    gauge.init();
    const double sigmas[3] = {0.02, 0.03, 0.05};
    prior = Mat3::Zero();
    for (int i = 0; i < 3; ++i) prior(i, i) = static_cast<Scalar>(sigmas[i] * sigmas[i]);
    for (int k = 0; k < kWalls; ++k) {
      plan[k].R_WP = exp_so3(Vec3(Scalar(1.5707963) * (k == 1), Scalar(1.5707963) * (k == 2), 0)).toRotationMatrix();
      plan[k].o_W = Scalar(-3) * plan[k].R_WP.col(2) + random.normals<3>(0.3);
    }
    for (int i = 0; i < 6; ++i) pose(i, i) = i < 3 ? Scalar(1e-4) : Scalar(4e-4);
    draw();
  }
  void draw() {
    for (Vec3& x : truth)
      for (int i = 0; i < 3; ++i) x(i) = static_cast<Scalar>(random.normal()) * std::sqrt(prior(i, i));
    gauge.init();
    for (int k = 0; k < kWalls; ++k) gauge.add(k, prior);
    gauge.begin(pose, first_W, sigma_scale);
  }
  /// How a map is moved whose first pose is off and whose size is: to where it should be.
  Similarity draw_move() {
    const Vec3 theta = random.normals<3>(0.01), p = random.normals<3>(0.02);
    const Scalar s = std::exp(sigma_scale * static_cast<Scalar>(random.normal()));
    Similarity T;
    T.q = exp_so3(theta);
    T.s = s;
    T.t = first_W + p - s * (T.q * first_W);
    return T;
  }
  /// Walls as a map has them that is moved by T to where it should be, off by sigma.
  void see(const Similarity& T, double sigma, MeasuredWall* out) {
    for (int k = 0; k < kWalls; ++k) {
      const PlaneFrame at = lying_frame(plan[k], truth[k] + random.normals<3>(sigma));
      const Mat3 back = T.q.conjugate().toRotationMatrix();
      const Mat3 R = Mat3::Identity() * static_cast<Scalar>(sigma * sigma);
      out[k] = {k, plan[k], {back * at.R_WP, back * (at.o_W - T.t) / T.s}, R, false};
    }
  }
};

/// The map is put where it should be, and its covariances hold: of a place in it, and of each wall.
void test_walls_should_place_the_map_and_know_how_well() {
  Bench bench(5);
  MeasuredWall seen[kWalls];
  double nees_place = 0, nees_wall = 0, worst_scale = 0;
  constexpr int kTrials = 400;
  for (int trial = 0; trial < kTrials; ++trial) {
    bench.draw();
    const Similarity truth = bench.draw_move();
    bench.see(truth, 2e-3, seen);
    const Similarity moved = bench.gauge.compare(seen, kWalls, Scalar(1e6));
    const Vec3 at(1, Scalar(0.5), -1), e = truth.of(at) - moved.of(at);
    const Mat3 P = bench.gauge.pose_covariance(moved.of(at)).bottomRightCorner<3, 3>();
    nees_place += static_cast<double>(e.dot(P.inverse() * e)) / kTrials;
    worst_scale = std::max(worst_scale, std::abs(std::log(static_cast<double>(truth.s / moved.s))));
    for (int k = 0; k < kWalls; ++k) {
      const Vec3 d = bench.truth[k] - bench.gauge.wall(k);
      nees_wall += static_cast<double>(d.dot(bench.gauge.wall_covariance(k).inverse() * d)) / (kTrials * kWalls);
    }
  }
  std::printf("NEES of a place %.2f, of a wall %.2f (3 each); scale off by at most %.3f\n", nees_place, nees_wall,
              worst_scale);
  TEST_ASSERT_TRUE(nees_place > 2.6 && nees_place < 3.4);
  TEST_ASSERT_TRUE(nees_wall > 2.6 && nees_wall < 3.4);
  TEST_ASSERT_TRUE(worst_scale < 0.1);
}

void test_the_covariance_of_the_first_pose_should_be_the_one_it_was_begun_with() {
  Bench bench(6);
  TEST_ASSERT_TRUE((bench.gauge.pose_covariance(bench.first_W) - bench.pose).norm() < Scalar(1e-6) * bench.pose.norm());
}

/// As if the wall had never been there, but for what its prior keeps.
void test_forgetting_a_wall_should_take_back_what_it_told() {
  Bench with(7), without(7);
  MeasuredWall seen[kWalls];
  with.see(with.draw_move(), 2e-3, seen);
  const Similarity T_with = with.gauge.compare(seen, kWalls, Scalar(1e6));
  const Similarity T_without = without.gauge.compare(seen, kWalls - 1, Scalar(1e6));
  const Similarity back = with.gauge.forget(kWalls - 1, with.prior, Scalar(1e7));
  const Mat6 P = with.gauge.pose_covariance(with.first_W), P_without = without.gauge.pose_covariance(with.first_W);
  TEST_ASSERT_TRUE((P - P_without).norm() < Scalar(0.05) * P_without.norm());
  const Vec3 at(1, Scalar(0.5), -1);
  const Scalar told = (T_with.of(at) - T_without.of(at)).norm();
  const Scalar left = (back.of(T_with.of(at)) - T_without.of(at)).norm();
  std::printf("it moved a place by %.4f, and what is left of that is %.4f\n", static_cast<double>(told),
              static_cast<double>(left));
  TEST_ASSERT_TRUE(left < Scalar(0.1) * told);
  TEST_ASSERT_FALSE(with.gauge.has(kWalls - 1));
}

void test_a_wall_that_is_elsewhere_should_change_nothing() {
  Bench bench(8);
  const Mat6 before = bench.gauge.pose_covariance(bench.first_W);
  MeasuredWall seen[kWalls];
  bench.see(Similarity(), 1e-3, seen);
  seen[0].frame.o_W += Scalar(2) * seen[0].frame.R_WP.col(2);
  const Similarity T = bench.gauge.compare(seen, 1, kGate);
  TEST_ASSERT_FALSE(seen[0].fits);
  TEST_ASSERT_TRUE((bench.gauge.pose_covariance(bench.first_W) - before).norm() == Scalar(0));
  TEST_ASSERT_TRUE(bench.gauge.wall(0).norm() == Scalar(0));
  TEST_ASSERT_TRUE(T.t.norm() == Scalar(0) && T.s == Scalar(1));
}

/// What the map may be off moves all of its planes, and so the place of a wall against a plane of the map.
void test_the_relative_covariance_should_be_that_of_what_is_measured() {
  Bench bench(9);
  MeasuredWall seen[kWalls];
  double nis = 0;
  constexpr int kTrials = 400;
  for (int trial = 0; trial < kTrials; ++trial) {
    bench.draw();
    const Mat3 S = bench.gauge.relative_covariance(1, bench.plan[1]);
    bench.see(bench.draw_move(), 0, seen);
    Vec3 z;
    TEST_ASSERT_TRUE(reframe_plane(seen[1].frame, Vec3::Zero(), bench.plan[1], &z));
    nis += static_cast<double>(z.dot(S.inverse() * z)) / kTrials;
  }
  std::printf("NIS %.2f of 3\n", nis);
  TEST_ASSERT_TRUE(nis > 2.6 && nis < 3.4);
}

/// Nothing but the plan gives the size of a map before parallel walls: however often they are compared, it is known no better than the mean
/// of their offsets.
void test_comparing_again_should_not_make_up_information() {
  Bench bench(10);
  bench.sigma_scale = Scalar(0.12);
  bench.plan[1] = bench.plan[0];
  bench.plan[1].o_W += Scalar(2) * bench.plan[0].R_WP.col(0);
  bench.draw();
  bench.truth[0](2) = Scalar(0.05);
  bench.truth[1](2) = Scalar(-0.06);
  MeasuredWall seen[kWalls];
  Similarity left = bench.draw_move();
  for (int n = 0; n < 40; ++n) {
    bench.see(left, 3e-3, seen);
    const Similarity T = bench.gauge.compare(seen, 2, Scalar(1e6));
    const Similarity back = {T.q.conjugate(), -(T.q.conjugate() * T.t) / T.s, 1 / T.s};
    left = {(left.q * back.q).normalized(), left.of(back.t), left.s * back.s};
  }
  const Scalar sigma = std::sqrt(bench.gauge.plane_covariance(bench.plan[0])(2, 2));
  const Scalar least = std::sqrt(bench.prior(2, 2) / 2);
  std::printf("sigma of the distance %.4f, of the mean of two offsets %.4f\n", static_cast<double>(sigma),
              static_cast<double>(least));
  TEST_ASSERT_TRUE(sigma >= least && sigma < Scalar(1.1) * least);
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_walls_should_place_the_map_and_know_how_well);
  RUN_TEST(test_the_covariance_of_the_first_pose_should_be_the_one_it_was_begun_with);
  RUN_TEST(test_forgetting_a_wall_should_take_back_what_it_told);
  RUN_TEST(test_a_wall_that_is_elsewhere_should_change_nothing);
  RUN_TEST(test_comparing_again_should_not_make_up_information);
  RUN_TEST(test_the_relative_covariance_should_be_that_of_what_is_measured);
  return UNITY_END();
}
