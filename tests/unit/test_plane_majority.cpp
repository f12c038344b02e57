// The plane of most points: which of them are off it, and how well it is known.
#include <unity.h>

#include <vector>

#include "geometry/so3.h"
#include "map/plane_majority.h"
#include "support/seeded_random.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

/// Points of a plane through the origin, known to sigma [m], the first `off` of them 3 cm beside it, in a world that has turned.
struct Set {
  std::vector<JudgedPoint> points;
  Mat3 R;

  Set(SeededRandom& random, int count, int off, double sigma) : R(exp_so3(random.normals<3>(0.5)).toRotationMatrix()) {
    for (int i = 0; i < count; ++i) {
      JudgedPoint p;
      const double own = sigma * random.uniform(0.5, 1.5);
      const double height = random.normal() * own + (i < off ? 0.03 : 0);
      p.p_W = R * Vec3(static_cast<Scalar>(random.uniform(-0.5, 0.5)), static_cast<Scalar>(random.uniform(-0.3, 0.3)),
                       static_cast<Scalar>(height));
      p.variance = static_cast<Scalar>(own * own);
      points.push_back(p);
    }
  }
  bool judge(MajorityPlane* plane, const MajoritySettings& settings = MajoritySettings()) {
    return find_majority(points.data(), static_cast<int>(points.size()), R.col(2), settings, 3, plane);
  }
};

void test_majority_should_name_the_points_that_are_off_and_no_others() {
  SeededRandom random(21);
  int judged = 0, wrong = 0, missed = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const int off = trial % 5;
    Set set(random, 16 + trial % 20, off, 0.002);
    MajorityPlane plane;
    if (!set.judge(&plane)) continue;
    ++judged;
    for (int i = 0; i < static_cast<int>(set.points.size()); ++i) {
      missed += i < off && !set.points[static_cast<std::size_t>(i)].is_off;
      wrong += i >= off && set.points[static_cast<std::size_t>(i)].is_off;
    }
  }
  std::printf("%d of 200 sets judged; of 400 points off %d missed, of 4,700 others %d refused\n", judged, missed,
              wrong);
  TEST_ASSERT_TRUE(judged >= 196);
  TEST_ASSERT_TRUE(missed <= 20);
  TEST_ASSERT_TRUE(wrong <= 2);
}

/// Errors of (h, t1, t2) in their own variances: three of them, or less, since a point may be rough.
void test_majority_should_know_its_plane_no_better_than_it_does() {
  SeededRandom random(22);
  double sum = 0;
  int judged = 0;
  for (int trial = 0; trial < 300; ++trial) {
    Set set(random, 20, trial % 4, 0.004);
    MajoritySettings settings;
    settings.roughness = Scalar(1e-4);
    MajorityPlane plane;
    if (!set.judge(&plane, settings)) continue;
    ++judged;
    const Vec3 n = set.R.col(2) * (plane.n_W.dot(set.R.col(2)) < 0 ? -1 : 1);
    const Vec3 error(n.dot(plane.c_W), n.dot(plane.e_W[0]), n.dot(plane.e_W[1]));
    sum += static_cast<double>(error.cwiseProduct(error).cwiseQuotient(plane.variance).sum());
  }
  std::printf("%d of 300 sets judged, mean squared error %.2f of three variances\n", judged, sum / judged);
  TEST_ASSERT_TRUE(judged >= 150);
  TEST_ASSERT_TRUE(sum / judged < 5);
  TEST_ASSERT_TRUE(sum / judged > 1.5);
}

/// Three points at one end, 3 cm above the others, by least squares over all: with equal weights in closed form.
void test_majority_should_say_how_points_that_are_off_would_bend_it() {
  SeededRandom random(24);
  MajoritySettings settings;
  settings.roughness = Scalar(0.002);
  for (int trial = 0; trial < 20; ++trial) {
    Set set(random, 30, 0, 1e-4);
    for (JudgedPoint& p : set.points) p.variance = Scalar(1e-8);
    for (std::size_t i = 0; i < 3; ++i)
      set.points[i].p_W = set.R * Vec3(Scalar(0.4), static_cast<Scalar>(0.1 * static_cast<double>(i)), Scalar(0.03));
    MajorityPlane plane;
    TEST_ASSERT_TRUE(set.judge(&plane, settings));
    TEST_ASSERT_EQUAL_INT(3, plane.off);
    Mat3 N = Mat3::Zero();
    Vec3 b = Vec3::Zero();
    for (const JudgedPoint& p : set.points) {
      const Vec3 r = p.p_W - plane.c_W, u(1, plane.e_W[0].dot(r), plane.e_W[1].dot(r));
      N += u * u.transpose();
      b += u * plane.n_W.dot(r);
    }
    const Vec3 expected = N.inverse() * b;
    TEST_ASSERT_TRUE((plane.bent - expected).norm() < Scalar(0.02) * expected.norm());
    TEST_ASSERT_TRUE(expected.norm() > Scalar(0.01));
  }
  Set clean(random, 30, 0, 0.002);
  MajorityPlane plane;
  TEST_ASSERT_TRUE(clean.judge(&plane));
  TEST_ASSERT_EQUAL_INT(0, plane.off);
  TEST_ASSERT_TRUE(plane.bent.norm() < Scalar(1e-3));
}

void test_majority_should_be_none_where_too_few_are_known_or_agree() {
  SeededRandom random(23);
  MajorityPlane plane;
  plane.members = -7;
  Set few(random, 7, 0, 0.001), vague(random, 30, 0, 0.03);
  TEST_ASSERT_FALSE(few.judge(&plane));
  TEST_ASSERT_FALSE(vague.judge(&plane));
  Set split(random, 20, 0, 0.001);
  for (std::size_t i = 0; i < 9; ++i)
    split.points[i].p_W += split.R.col(2) * static_cast<Scalar>(random.uniform(0.03, 0.3));
  TEST_ASSERT_FALSE(split.judge(&plane));
  TEST_ASSERT_EQUAL_INT(-7, plane.members);
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_majority_should_name_the_points_that_are_off_and_no_others);
  RUN_TEST(test_majority_should_know_its_plane_no_better_than_it_does);
  RUN_TEST(test_majority_should_say_how_points_that_are_off_would_bend_it);
  RUN_TEST(test_majority_should_be_none_where_too_few_are_known_or_agree);
  return UNITY_END();
}
