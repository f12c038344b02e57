// Pose from points: all solutions of three, degenerate sets, wrong matches, refinement and its covariance.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "geometry/p3p.h"
#include "geometry/pnp.h"
#include "geometry/small_cholesky.h"
#include "geometry/so3.h"
#include "same.h"
#include "support/seeded_random.h"
#include "support/test_cameras.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr bool kFloat = sizeof(Scalar) == 4;
constexpr double kNear = kFloat ? 1e-3 : 1e-6;

struct Scene {
  CameraPose truth;
  Vec3 point[3], ray[3];
};

Scene random_scene(SeededRandom& random) {
  Scene s;
  s.truth.q_WC = exp_so3(random.normals<3>(0.7));
  s.truth.p_WC = random.normals<3>(0.5);
  for (int i = 0; i < 3; ++i) {
    s.ray[i] = Vec3(static_cast<Scalar>(random.uniform(-0.6, 0.6)), static_cast<Scalar>(random.uniform(-0.5, 0.5)), 1);
    s.point[i] = s.truth.p_WC + s.truth.q_WC * Vec3(s.ray[i] * static_cast<Scalar>(random.uniform(1, 4)));
  }
  return s;
}

double distance(const CameraPose& a, const CameraPose& b) {
  return static_cast<double>((a.p_WC - b.p_WC).norm() + log_so3(a.q_WC * b.q_WC.conjugate()).norm());
}

/// Solutions of the three distance equations, counted without a polynomial: for each distance of the first point the two equations that
/// hold it give the others, and the third one's sign changes are counted on a fine grid.
int count_by_scanning(const Scene& s) {
  constexpr int kSteps = 20000;
  double side2[3], cosine[3];
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    side2[k] = static_cast<double>((s.point[i] - s.point[j]).squaredNorm());
    cosine[k] = static_cast<double>(s.ray[i].normalized().dot(s.ray[j].normalized()));
  }
  // By the law of sines no distance is longer than a side that its point is in over the sine between the rays there.
  const double longest =
      std::sqrt(std::min(side2[2] / (1 - cosine[2] * cosine[2]), side2[1] / (1 - cosine[1] * cosine[1])));
  int count = 0;
  for (int branch = 0; branch < 4; ++branch) {
    const double sign1 = branch % 2 == 0 ? 1 : -1, sign2 = branch / 2 == 0 ? 1 : -1;
    double last = 0;
    bool has_last = false;
    for (int k = 1; k <= kSteps; ++k) {
      const double s0 = longest * k / kSteps;
      const double D1 = side2[2] - s0 * s0 * (1 - cosine[2] * cosine[2]);
      const double D2 = side2[1] - s0 * s0 * (1 - cosine[1] * cosine[1]);
      if (D1 < 0 || D2 < 0) {
        has_last = false;
        continue;
      }
      const double s1 = s0 * cosine[2] + sign1 * std::sqrt(D1), s2 = s0 * cosine[1] + sign2 * std::sqrt(D2);
      const double r = s1 * s1 + s2 * s2 - 2 * s1 * s2 * cosine[0] - side2[0];
      if (s1 <= 0 || s2 <= 0) {
        has_last = false;
        continue;
      }
      if (has_last && (r < 0) != (last < 0)) ++count;
      last = r;
      has_last = true;
    }
  }
  return count;
}

void test_p3p_should_contain_the_true_pose() {
  SeededRandom random(31);
  constexpr int kTrials = 20000;
  int missed = 0, several = 0;
  double sum = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Scene s = random_scene(random);
    CameraPose pose[kMaxP3pSolutions];
    const int count = solve_p3p(s.point, s.ray, pose);
    double nearest = 1e9;
    for (int k = 0; k < count; ++k) {
      nearest = std::min(nearest, distance(pose[k], s.truth));
      for (int i = 0; i < 3; ++i) {  // each explains its rays
        const Vec3 seen = pose[k].q_WC.conjugate() * (s.point[i] - pose[k].p_WC);
        TEST_ASSERT_DOUBLE_WITHIN(kNear, 0, static_cast<double>((seen.normalized() - s.ray[i].normalized()).norm()));
      }
    }
    if (!(nearest < (kFloat ? 3e-2 : 1e-4)))
      ++missed;
    else
      sum += nearest;
    if (count > 1) ++several;
  }
  std::printf("missed %d of %d, %d with several solutions, mean error %.2g\n", missed, kTrials, several, sum / kTrials);
  TEST_ASSERT_LESS_OR_EQUAL_INT(kFloat ? kTrials / 200 : 2, missed);
  TEST_ASSERT_GREATER_THAN_INT(kTrials / 4, several);
}

void test_p3p_should_find_as_many_solutions_as_a_scan_of_the_distances() {
  SeededRandom random(32);
  int by_count[5] = {}, differing = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const Scene s = random_scene(random);
    CameraPose pose[kMaxP3pSolutions];
    const int count = solve_p3p(s.point, s.ray, pose), scanned = count_by_scanning(s);
    ++by_count[count];
    // Two solutions between two steps of the scan do not show in it, nor does one beside the end of a branch.
    if (count != scanned) ++differing;
    if (count < scanned) std::printf("trial %d: %d of %d\n", trial, count, scanned);
    TEST_ASSERT_GREATER_OR_EQUAL_INT(scanned, count);
  }
  std::printf("solutions 0..4: %d %d %d %d %d, not the scan's number: %d\n", by_count[0], by_count[1], by_count[2],
              by_count[3], by_count[4], differing);
  TEST_ASSERT_EQUAL_INT(0, by_count[0]);
  TEST_ASSERT_GREATER_THAN_INT(0, by_count[4]);
  TEST_ASSERT_LESS_OR_EQUAL_INT(6, differing);
}

void test_p3p_should_have_four_solutions_for_a_camera_above_an_equilateral_triangle() {
  Scene s;
  for (int i = 0; i < 3; ++i) {
    const double a = 2.0943951023931953 * i;
    s.point[i] = Vec3(static_cast<Scalar>(std::cos(a)), static_cast<Scalar>(std::sin(a)), 0);
    s.ray[i] = s.point[i] + Vec3(0, 0, 2);
  }
  s.truth.p_WC = Vec3(0, 0, -2);
  CameraPose pose[kMaxP3pSolutions];
  const int count = solve_p3p(s.point, s.ray, pose);
  TEST_ASSERT_EQUAL_INT(4, count);
  double nearest = 1e9;
  for (int k = 0; k < count; ++k) nearest = std::min(nearest, distance(pose[k], s.truth));
  TEST_ASSERT_DOUBLE_WITHIN(kNear, 0, nearest);
}

void test_p3p_should_refuse_degenerate_sets() {
  SeededRandom random(33);
  CameraPose pose[kMaxP3pSolutions];
  for (int trial = 0; trial < 200; ++trial) {
    const Scene s = random_scene(random);
    Vec3 line[3] = {s.point[0], s.point[1], s.point[0] + Scalar(0.3) * (s.point[1] - s.point[0])};
    TEST_ASSERT_EQUAL_INT(0, solve_p3p(line, s.ray, pose));
    Vec3 twice[3] = {s.point[0], s.point[1], s.point[1]};
    TEST_ASSERT_EQUAL_INT(0, solve_p3p(twice, s.ray, pose));
    Vec3 rays[3] = {s.ray[0], s.ray[1], Scalar(2) * s.ray[0]};
    TEST_ASSERT_EQUAL_INT(0, solve_p3p(s.point, rays, pose));
    Vec3 nowhere[3] = {s.point[0], s.point[1], s.point[2] * std::numeric_limits<Scalar>::quiet_NaN()};
    TEST_ASSERT_EQUAL_INT(0, solve_p3p(nowhere, s.ray, pose));
    Vec3 zero[3] = {s.ray[0], Vec3::Zero(), s.ray[2]};
    TEST_ASSERT_EQUAL_INT(0, solve_p3p(s.point, zero, pose));
  }
}

constexpr int kPoints = 100;

/// Points in view of a random pose; the first `wrong` have pixels anywhere in the image. Every third one is given up to scale.
PoseEstimate random_view(SeededRandom& random, const Camera& camera, int wrong, double sigma, PnpPoint* points) {
  PoseEstimate truth;
  truth.q_WC = exp_so3(random.normals<3>(0.5));
  truth.p_WC = random.normals<3>(0.5);
  for (int i = 0; i < kPoints;) {
    const Vec2 at(static_cast<Scalar>(random.uniform(20, camera.width - 20)),
                  static_cast<Scalar>(random.uniform(20, camera.height - 20)));
    Vec3 ray;
    if (!unproject(camera, at, &ray)) continue;
    const Vec3 p_W = truth.p_WC + truth.q_WC * Vec3(ray * static_cast<Scalar>(random.uniform(1, 4)));
    const Scalar w = i % 3 == 0 ? Scalar(0.5) : Scalar(1);
    points[i].m = w * p_W;
    points[i].w = w;
    points[i].pixel = at + random.normals<2>(sigma);
    if (i < wrong)
      points[i].pixel = Vec2(static_cast<Scalar>(random.uniform(0, camera.width)),
                             static_cast<Scalar>(random.uniform(0, camera.height)));
    ++i;
  }
  return truth;
}

Vec6 error_of(const PoseEstimate& truth, const PoseEstimate& estimate) {
  Vec6 e;
  e << log_so3(truth.q_WC * estimate.q_WC.conjugate()), truth.p_WC - estimate.p_WC;
  return e;
}

constexpr PnpSearch kSearch = {Scalar(2), 200, 8, {Scalar(0.5), Scalar(2), 20}};

void test_find_pose_should_find_it_among_60_percent_of_wrong_matches() {
  SeededRandom random(34);
  double nees = 0;
  int found = 0, right = 0;
  constexpr int kTrials = 200, kWrong = 60;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Camera camera = test_camera_of(trial % kTestCameras);
    PnpPoint points[kPoints];
    unsigned char inliers[kPoints];
    const PoseEstimate truth = random_view(random, camera, kWrong, 0.5, points);
    PoseEstimate pose;  // far from the truth
    std::uint32_t seed = static_cast<std::uint32_t>(trial);
    if (find_pose(camera, points, kPoints, kSearch, &seed, &pose, inliers) == 0) continue;
    ++found;
    for (int i = kWrong; i < kPoints; ++i) right += inliers[i];
    SmallCholesky<6> factored;
    TEST_ASSERT_TRUE(factored.factor(pose.covariance));
    const Vec6 e = error_of(truth, pose);
    nees += static_cast<double>(e.dot(factored.solve<1>(e)));
  }
  std::printf("found %d of %d, inliers kept %.3f, NEES %.2f (6)\n", found, kTrials,
              right / static_cast<double>(found * (kPoints - kWrong)), nees / found);
  TEST_ASSERT_GREATER_OR_EQUAL_INT(kTrials * 99 / 100, found);
  TEST_ASSERT_GREATER_THAN_INT(found * (kPoints - kWrong) * 99 / 100, right);
  TEST_ASSERT_DOUBLE_WITHIN(1.5, 6, nees / found);
}

void test_find_pose_should_say_so_when_nothing_agrees() {
  SeededRandom random(35);
  PnpPoint points[kPoints];
  unsigned char inliers[kPoints];
  const Camera camera = test_camera_of(0);
  int found = 0;
  for (int trial = 0; trial < 50; ++trial) {
    random_view(random, camera, kPoints, 0.5, points);
    PoseEstimate pose;
    std::uint32_t seed = 1;
    if (find_pose(camera, points, kPoints, kSearch, &seed, &pose, inliers) != 0)
      ++found;
    else
      TEST_ASSERT_SAME(Vec3::Zero(), pose.p_WC);
    TEST_ASSERT_SAME(Scalar(1), pose.q_WC.w());
  }
  TEST_ASSERT_EQUAL_INT(0, found);
  std::uint32_t seed = 1;
  PoseEstimate pose;
  TEST_ASSERT_EQUAL_INT(0, find_pose(camera, points, 0, kSearch, &seed, &pose, inliers));
  TEST_ASSERT_EQUAL_INT(0, find_pose(camera, points, 2, kSearch, &seed, &pose, inliers));
}

void test_find_pose_should_repeat_itself_for_the_same_seed() {
  SeededRandom random(36);
  PnpPoint points[kPoints];
  unsigned char inliers[kPoints];
  const Camera camera = test_camera_of(1);
  random_view(random, camera, 50, 0.5, points);
  PoseEstimate pose[2];
  for (PoseEstimate& p : pose) {
    std::uint32_t seed = 7;
    TEST_ASSERT_GREATER_THAN_INT(0, find_pose(camera, points, kPoints, kSearch, &seed, &p, inliers));
  }
  TEST_ASSERT_SAME(pose[1].p_WC, pose[0].p_WC);
  TEST_ASSERT_SAME(pose[1].q_WC.coeffs(), pose[0].q_WC.coeffs());
}

void test_refine_pnp_should_refuse_what_fixes_no_pose() {
  SeededRandom random(37);
  PnpPoint points[kPoints];
  const Camera camera = test_camera_of(0);
  PoseEstimate pose = random_view(random, camera, 0, 0, points);
  const PoseEstimate before = pose;
  unsigned char two[kPoints] = {1, 1};
  const PnpRefinement options = {Scalar(0.5), Scalar(2), 20};
  TEST_ASSERT_FALSE(refine_pnp(camera, points, kPoints, two, options, &pose));
  for (PnpPoint& p : points) p.w = Scalar(0);  // directions alone say nothing of the position
  TEST_ASSERT_FALSE(refine_pnp(camera, points, kPoints, nullptr, options, &pose));
  TEST_ASSERT_SAME(before.p_WC, pose.p_WC);
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_p3p_should_contain_the_true_pose);
  RUN_TEST(test_p3p_should_find_as_many_solutions_as_a_scan_of_the_distances);
  RUN_TEST(test_p3p_should_have_four_solutions_for_a_camera_above_an_equilateral_triangle);
  RUN_TEST(test_p3p_should_refuse_degenerate_sets);
  RUN_TEST(test_find_pose_should_find_it_among_60_percent_of_wrong_matches);
  RUN_TEST(test_find_pose_should_say_so_when_nothing_agrees);
  RUN_TEST(test_find_pose_should_repeat_itself_for_the_same_seed);
  RUN_TEST(test_refine_pnp_should_refuse_what_fixes_no_pose);
  return UNITY_END();
}
