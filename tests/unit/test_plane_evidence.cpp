// What points say together of whether they lie on one plane.
#include <cmath>
#include <limits>

#include "map/plane_evidence.h"
#include "support/seeded_random.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr Scalar kFirst = 2, kRoughness = Scalar(0.002);

/// Points within 0.3 m of each other, with heights of this sigma that are known to sigma, and of which all share a plane of `shared`.
JointDistances points(int count, Scalar height, Scalar sigma, Scalar shared, SeededRandom* random) {
  JointDistances z;
  z.count = count;
  for (int i = 0; i < count; ++i) {
    z.d[i] = height * static_cast<Scalar>(random->normal());
    const auto u = static_cast<Scalar>(random->uniform(-0.3, 0.3)), v = static_cast<Scalar>(random->uniform(-0.3, 0.3));
    z.uv[i] = Vec2(u, v);
    for (int j = 0; j <= i; ++j) {
      const Scalar common = shared * shared * (1 + z.uv[i].dot(z.uv[j]));
      z.S[i * count + j] = common + (i == j ? sigma * sigma : Scalar(0));
    }
  }
  return z;
}

void test_points_should_say_nothing_together_when_they_have_no_parallax() {
  SeededRandom random(11);
  for (const int count : {4, 8, kMaxJoint}) {
    const JointDistances z = points(count, Scalar(0.1), kFirst, Scalar(0), &random);
    TEST_ASSERT_TRUE(std::abs(log_odds_of_plane(z, kFirst, kRoughness)) < Scalar(0.1));
  }
}

void test_three_points_should_say_nothing() {
  SeededRandom random(12);
  const JointDistances z = points(3, Scalar(0.01), Scalar(0.001), Scalar(0), &random);
  TEST_ASSERT_TRUE(std::abs(log_odds_of_plane(z, kFirst, kRoughness)) < Scalar(0.01));
}

void test_points_on_a_plane_should_say_more_the_better_they_are_known() {
  SeededRandom random(13);
  const JointDistances z = points(8, Scalar(0.001), Scalar(0.001), Scalar(0), &random);
  SeededRandom again(13);
  const JointDistances loose = points(8, Scalar(0.001), Scalar(0.1), Scalar(0), &again);
  // Five distances beyond the three of a plane, each known to 2.2 mm in place of 2 m, and to 100 mm.
  const Scalar sure = log_odds_of_plane(z, kFirst, kRoughness), unsure = log_odds_of_plane(loose, kFirst, kRoughness);
  TEST_ASSERT_TRUE(std::abs(sure - 5 * std::log(Scalar(2 / 0.002236))) < Scalar(1));
  TEST_ASSERT_TRUE(std::abs(unsure - 5 * std::log(Scalar(2 / 0.1))) < Scalar(0.2));
}

void test_what_all_points_share_should_take_nothing_away() {
  SeededRandom random(14), again(14);
  const JointDistances alone = points(8, Scalar(0.001), Scalar(0.001), Scalar(0), &random);
  const JointDistances shared = points(8, Scalar(0.001), Scalar(0.001), Scalar(0.5), &again);
  const Scalar a = log_odds_of_plane(alone, kFirst, kRoughness), b = log_odds_of_plane(shared, kFirst, kRoughness);
  TEST_ASSERT_TRUE(std::abs(a - b) < Scalar(0.01) * std::abs(a));
  // Each by itself they would be unsure by half a metre.
  JointDistances apart = shared;
  for (int i = 0; i < apart.count; ++i)
    for (int j = 0; j < i; ++j) apart.S[i * apart.count + j] = Scalar(0);
  TEST_ASSERT_TRUE(log_odds_of_plane(apart, kFirst, kRoughness) < b / 2);
}

void test_points_should_speak_against_a_plane_when_they_are_known_to_lie_elsewhere() {
  SeededRandom random(15);
  const JointDistances z = points(8, Scalar(0.05), Scalar(0.001), Scalar(0), &random);
  TEST_ASSERT_TRUE(log_odds_of_plane(z, kFirst, kRoughness) < -100);
}

void test_odds_should_be_none_when_a_covariance_is_none() {
  SeededRandom random(16);
  JointDistances z = points(5, Scalar(0.001), Scalar(0.001), Scalar(0), &random);
  z.S[0] = -1;
  TEST_ASSERT_TRUE(log_odds_of_plane(z, kFirst, kRoughness) == -std::numeric_limits<Scalar>::infinity());
  z = points(5, Scalar(0.001), Scalar(0.001), Scalar(0), &random);
  z.d[2] = std::numeric_limits<Scalar>::quiet_NaN();
  TEST_ASSERT_TRUE(log_odds_of_plane(z, kFirst, kRoughness) == -std::numeric_limits<Scalar>::infinity());
  z = points(5, Scalar(0.001), Scalar(0.001), Scalar(0), &random);
  for (int i = 0; i < z.count; ++i) z.uv[i] = Vec2::Zero();  // on one spot: no plane
  TEST_ASSERT_TRUE(log_odds_of_plane(z, kFirst, kRoughness) == -std::numeric_limits<Scalar>::infinity());
}

void test_choices_should_be_those_of_subsets_of_a_ball() {
  // 5 of 7 points: 21 subsets, 8 sizes, and a ball about one of 10 points, up to one of 10.
  TEST_ASSERT_TRUE(std::abs(log_choices(5, 7, 10) - std::log(Scalar(21 * 8 * 100))) < Scalar(1e-3));
  TEST_ASSERT_TRUE(std::abs(log_choices(5, 5, 5) - std::log(Scalar(6 * 25))) < Scalar(1e-3));
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_points_should_say_nothing_together_when_they_have_no_parallax);
  RUN_TEST(test_three_points_should_say_nothing);
  RUN_TEST(test_points_on_a_plane_should_say_more_the_better_they_are_known);
  RUN_TEST(test_what_all_points_share_should_take_nothing_away);
  RUN_TEST(test_points_should_speak_against_a_plane_when_they_are_known_to_lie_elsewhere);
  RUN_TEST(test_odds_should_be_none_when_a_covariance_is_none);
  RUN_TEST(test_choices_should_be_those_of_subsets_of_a_ball);
  return UNITY_END();
}
