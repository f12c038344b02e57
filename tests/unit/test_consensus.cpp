// One-point consensus: right matches agree with each other, wrong ones do not, whoever comes first.
#include "slam/consensus.h"
#include "support/filter_scene.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr int kMatches = 30;
constexpr Scalar kGate = Scalar(9.2103);  // 99 % with two degrees of freedom

/// A known map, a camera whose direction is hardly known (its place and its roll are), and matches of which the first `wrong` (then shuffled) are random pixels
/// inside of their own search ellipse.
struct Matches {
  TestFilter filter{true};
  PixelMeasurement observation[kMatches];
  bool is_wrong[kMatches];

  Matches(SeededRandom& random, int wrong) {
    const std::vector<int> slots = fill_map(random, filter, kMatches, 0);
    // With the roll known, one match fixes the turn, and what agrees by chance is a small part of an ellipse.
    const Vec3 sigma(Scalar(0.02), Scalar(0.02), Scalar(0.001));
    const Mat3 R_WC = filter->state().body.q_WC.toRotationMatrix();
    const Mat3 turned = R_WC * sigma.cwiseAbs2().asDiagonal() * R_WC.transpose();
    Dense P = Dense::Identity(filter.dim(), filter.dim()) * 1e-8;
    P.block(Body::kTheta, Body::kTheta, 3, 3) = turned.cast<double>();
    P.block(Body::kPosition, Body::kPosition, 3, 3) *= 100;
    filter.set_P(P);
    const Camera camera = pinhole_camera();
    Body truth = filter->state().body;
    truth.q_WC = truth.q_WC * exp_so3(random.normals<3>(1).cwiseProduct(sigma));
    truth.p_W += random.normals<3>(1e-3);
    for (int i = 0; i < kMatches; ++i) {
      PixelMeasurement& o = observation[i];
      TEST_ASSERT_TRUE(filter->predict_pixel(camera, slots[static_cast<std::size_t>(i)], &o));
      o.set_noise(Mat2::Identity() * Scalar(0.25));
      Mat26 J_body;
      Mat23 J_point;
      Vec2 z;
      const Vec3 f_W = filter->state().block[o.block].xyz();
      TEST_ASSERT_TRUE(project(camera, truth.q_WC.conjugate() * (f_W - truth.p_W), &z));
      is_wrong[i] = (i * 7 + 3) % kMatches < wrong;
      o.measured = is_wrong[i] ? chance(random, o) : Vec2(z + random.normals<2>(0.5));
    }
    filter->begin_update(observation, kMatches);
  }

  Vec2 chance(SeededRandom& random, const PixelMeasurement& o) {
    const Mat2 S = filter->innovation(o) + o.R_gate;
    for (;;) {
      const Scalar size = Scalar(3.1) * std::sqrt(std::max(S(0, 0), S(1, 1)));
      const Vec2 r(size * static_cast<Scalar>(random.uniform(-1, 1)),
                   size * static_cast<Scalar>(random.uniform(-1, 1)));
      if (squared_distance(r, S) < kGate) return o.predicted + r;
    }
  }
};

void test_consensus_should_reject_wrong_matches_when_three_in_ten_are_wrong() {
  SeededRandom random(101);
  constexpr int kTrials = 50, kWrong = 9;
  int wrong_kept = 0, right_kept = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    Matches m(random, kWrong);
    unsigned char keep[kMatches];
    const int agreed = find_inliers(*m.filter, m.observation, kMatches, kGate, keep);
    int kept = 0;
    for (int i = 0; i < kMatches; ++i) {
      kept += keep[i];
      (m.is_wrong[i] ? wrong_kept : right_kept) += keep[i];
    }
    TEST_ASSERT_EQUAL_INT(kept, agreed);
  }
  const double right_share = right_kept / double(kTrials * (kMatches - kWrong));
  const double wrong_share = wrong_kept / double(kTrials * kWrong);
  std::printf("kept: %.4f of the right ones, %.4f of the wrong ones\n", right_share, wrong_share);
  TEST_ASSERT_TRUE(right_share > 0.97);
  TEST_ASSERT_TRUE(wrong_share < 0.05);
}

void test_consensus_should_keep_as_many_as_the_gate_says_when_all_are_right() {
  SeededRandom random(102);
  int kept = 0;
  constexpr int kTrials = 50;
  for (int trial = 0; trial < kTrials; ++trial) {
    Matches m(random, 0);
    unsigned char keep[kMatches];
    kept += find_inliers(*m.filter, m.observation, kMatches, kGate, keep);
  }
  std::printf("kept: %.4f\n", kept / double(kTrials * kMatches));
  TEST_ASSERT_TRUE(kept >= 0.985 * kTrials * kMatches);
}

void test_consensus_should_find_few_when_all_matches_are_random() {
  SeededRandom random(103);
  for (int trial = 0; trial < 50; ++trial) {
    Matches m(random, kMatches);
    unsigned char keep[kMatches];
    const int agreed = find_inliers(*m.filter, m.observation, kMatches, kGate, keep);
    TEST_ASSERT_GREATER_OR_EQUAL_INT(1, agreed);  // the hypothesis agrees with itself
    TEST_ASSERT_LESS_OR_EQUAL_INT(6, agreed);
  }
}

void test_squared_distance_should_be_that_of_the_inverse_covariance() {
  SeededRandom random(104);
  for (int trial = 0; trial < 50; ++trial) {
    const Mat2 A = (Mat2() << random.normals<2>(1), random.normals<2>(1)).finished();
    const Mat2 S = A * A.transpose() + Mat2::Identity() * Scalar(0.1);
    const Vec2 r = random.normals<2>(3);
    const Scalar expected = r.dot(S.inverse() * r);
    TEST_ASSERT_TRUE(std::abs(squared_distance(r, S) - expected) < Scalar(1e-9) * (1 + expected));
  }
  const Mat2 broken = -Mat2::Identity();
  TEST_ASSERT_TRUE(squared_distance(Vec2(1, 0), broken) > Scalar(1e9));
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_consensus_should_reject_wrong_matches_when_three_in_ten_are_wrong);
  RUN_TEST(test_consensus_should_keep_as_many_as_the_gate_says_when_all_are_right);
  RUN_TEST(test_consensus_should_find_few_when_all_matches_are_random);
  RUN_TEST(test_squared_distance_should_be_that_of_the_inverse_covariance);
  return UNITY_END();
}
