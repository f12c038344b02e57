// A pose from matches with known points of which half are wrong, and what the prior does where matches say little.
#include "filter_slam/recovery/pose_proposal.h"
#include "same.h"
#include "support/filter_scene.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr int kCount = 40;
constexpr Scalar kSigma = Scalar(1.5);

struct Matches {
  const Camera camera = pinhole_camera();
  Body prior, truth;
  Mat6 P = Mat6::Zero();
  Vec3 f_W[kCount];
  Vec2 pixel[kCount];

  Matches(SeededRandom& random, int right) {
    const Scalar sigma = Scalar(0.1);
    P = Mat6::Identity() * (sigma * sigma);
    prior = random_body(random);
    truth = moved(prior, Vec6(random.normals<6>(0.1)));
    for (int i = 0; i < kCount; ++i) {
      do f_W[i] = point_in_view(random, truth);
      while (!project(camera, truth.q_WC.conjugate() * (f_W[i] - truth.p_W), &pixel[i]));
      if (i < right)
        pixel[i] += random.normals<2>(0.7);
      else
        pixel[i] = Vec2(static_cast<Scalar>(random.uniform(0, 640)), static_cast<Scalar>(random.uniform(0, 480)));
    }
  }
};

Scalar error(const Body& a, const Body& b) {
  return log_so3(a.q_WC * b.q_WC.conjugate()).norm() + (a.p_W - b.p_W).norm();
}

void test_pose_should_be_found_when_half_of_the_matches_are_wrong() {
  SeededRandom random(131);
  for (int trial = 0; trial < 30; ++trial) {
    const Matches m(random, kCount / 2);
    Body pose = m.prior;
    const int inliers = propose_pose(m.camera, m.P, m.f_W, m.pixel, kCount, kSigma, &pose);
    TEST_ASSERT_GREATER_OR_EQUAL_INT(kCount / 2 - 1, inliers);
    TEST_ASSERT_LESS_OR_EQUAL_INT(kCount / 2 + 3, inliers);
    TEST_ASSERT_TRUE(error(pose, m.truth) < Scalar(0.02));
    TEST_ASSERT_SAME(m.prior.v_W, pose.v_W);
    TEST_ASSERT_SAME(m.prior.w_C, pose.w_C);
  }
}

void test_few_inliers_should_be_found_when_all_matches_are_wrong() {
  SeededRandom random(132);
  int most = 0;
  for (int trial = 0; trial < 50; ++trial) {
    const Matches m(random, 0);
    Body pose = m.prior;
    most = std::max(most, propose_pose(m.camera, m.P, m.f_W, m.pixel, kCount, kSigma, &pose));
  }
  std::printf("at most %d inliers\n", most);
  TEST_ASSERT_LESS_THAN_INT(8, most);
}

/// At the minimum the cost of the header's comment does not fall in any direction (central differences).
void test_pose_should_minimise_the_cost_that_the_header_states() {
  SeededRandom random(133);
  for (int trial = 0; trial < 20; ++trial) {
    const Matches m(random, kCount);
    Body pose = m.prior;
    TEST_ASSERT_EQUAL_INT(kCount, propose_pose(m.camera, m.P, m.f_W, m.pixel, kCount, 4 * kSigma, &pose));
    const auto cost = [&](const Body& at) {
      double sum = 0;
      for (int i = 0; i < kCount; ++i) {
        Vec2 z;
        TEST_ASSERT_TRUE(project(m.camera, at.q_WC.conjugate() * (m.f_W[i] - at.p_W), &z));
        sum += static_cast<double>((m.pixel[i] - z).squaredNorm() / (16 * kSigma * kSigma));
      }
      Vec6 e;
      e << log_so3(at.q_WC * m.prior.q_WC.conjugate()), at.p_W - m.prior.p_W;
      return sum + static_cast<double>(e.dot(m.P.inverse() * e));
    };
    const double here = cost(pose);
    for (int k = 0; k < 6; ++k) {
      for (const double step : {-2e-3, 2e-3}) {
        Vec6 e = Vec6::Zero();
        e(k) = static_cast<Scalar>(step);
        TEST_ASSERT_TRUE(cost(moved(pose, e)) > here);
      }
    }
  }
}

void test_fewer_than_four_matches_should_give_no_pose() {
  SeededRandom random(134);
  const Matches m(random, kCount);
  Body pose = m.prior;
  TEST_ASSERT_EQUAL_INT(0, propose_pose(m.camera, m.P, m.f_W, m.pixel, 3, kSigma, &pose));
  TEST_ASSERT_SAME(m.prior.p_W, pose.p_W);
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_pose_should_be_found_when_half_of_the_matches_are_wrong);
  RUN_TEST(test_few_inliers_should_be_found_when_all_matches_are_wrong);
  RUN_TEST(test_pose_should_minimise_the_cost_that_the_header_states);
  RUN_TEST(test_fewer_than_four_matches_should_give_no_pose);
  return UNITY_END();
}
