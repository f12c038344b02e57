// One-point consensus: right matches agree with each other, wrong ones do not, whoever comes first.
#include <algorithm>
#include <limits>

#include "filter_slam/pose/consensus.h"
#include "support/filter_scene.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr int kMatches = 30;
constexpr Scalar kGate = Scalar(9.2103);  // 99 % with two degrees of freedom

/// A known map, a camera whose direction is hardly known (its place and its roll are), and matches of which the first `wrong` (then
/// shuffled) are random pixels inside of their own search ellipse.
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

/// Measurements of `kRows` rows over the body, of which the last `wrong` are 20 standard deviations off; what find_inliers says of them
/// is what dense matrices say.
template <int kRows>
void check_height(SeededRandom& random, Scalar gate) {
  constexpr int kCount = 9, kWrong = 3;
  using Observation = MeasurementOf<kRows, 6, 1>;
  for (int trial = 0; trial < 20; ++trial) {
    TestFilter filter(true);
    fill_map(random, filter, 4, 0);
    filter.set_P(random_covariance(random, filter.dim(), 0.1));
    const Dense P = filter.P();
    const Dense L = lower_factor(P);
    Dense e = Dense::Zero(filter.dim(), 1);
    for (int i = 0; i < filter.dim(); ++i) e(i) = random.normal();
    e = L * e;
    Observation z[kCount];
    Measurement view[kCount];
    std::vector<Dense> H;
    for (int i = 0; i < kCount; ++i) {
      z[i].H.parts = 1;
      z[i].H.part[0] = Part::body(0, 6);
      for (int k = 0; k < kRows * 6; ++k) z[i].H.h[k] = static_cast<Scalar>(random.normal());
      z[i].set_noise(Observation::Matrix::Identity() * Scalar(1e-4));
      H.push_back(dense_rows(*filter, z[i].H));
      const Dense right = H.back() * e;
      for (int k = 0; k < kRows; ++k)
        z[i].measured(k) = static_cast<Scalar>(right(k) + 0.01 * random.normal() + (i < kCount - kWrong ? 0 : 0.2));
      view[i] = z[i].view();
    }
    filter->begin_update(view, kCount);
    unsigned char keep[kCount];
    const int found = find_inliers(*filter, z, kCount, gate, keep);
    // The same with dense matrices: the best hypothesis, and whom it takes.
    int best = 0;
    std::vector<std::vector<bool>> taken;
    for (int i = 0; i < kCount; ++i) {
      const Dense R = Dense::Identity(kRows, kRows) * 1e-4;
      const Dense S_ii = H[i] * P * H[i].transpose() + R;
      int inliers = 0;
      taken.emplace_back();
      for (int j = 0; j < kCount; ++j) {
        const Dense S_ji = H[j] * P * H[i].transpose();
        const Dense r =
            z[j].measured.template cast<double>() - S_ji * solved(S_ii, z[i].measured.template cast<double>());
        const Dense S = H[j] * P * H[j].transpose() + R - S_ji * solved(S_ii, S_ji.transpose());
        taken.back().push_back(i == j || (r.transpose() * solved(S, r))(0, 0) < static_cast<double>(gate));
        inliers += taken.back().back();
      }
      best = std::max(best, inliers);
    }
    TEST_ASSERT_EQUAL_INT(best, found);
    const std::vector<bool> kept(keep, keep + kCount);
    TEST_ASSERT_TRUE(std::find(taken.begin(), taken.end(), kept) != taken.end());
    if (kRows == 8)
      for (int i = 0; i < kCount; ++i) TEST_ASSERT_EQUAL_INT(i < kCount - kWrong, keep[i]);
  }
}

void test_consensus_should_take_measurements_of_one_and_of_eight_rows() {
  SeededRandom random(105);
  check_height<1>(random, Scalar(6.635));
  check_height<8>(random, Scalar(26.12));  // 99.9 % with eight degrees of freedom
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

/// Covariances of which the determinant is infinite once gave a distance that is no number.
void test_a_covariance_should_be_none_when_a_distance_cannot_be_computed_from_it() {
  const Scalar huge = 4 * std::sqrt(std::numeric_limits<Scalar>::max());
  TEST_ASSERT_TRUE(is_covariance(Mat2(Mat2::Identity())));
  TEST_ASSERT_FALSE(is_covariance(Mat2(Mat2::Identity() * huge)));
  TEST_ASSERT_FALSE(is_covariance(Mat2(Mat2::Ones())));
  TEST_ASSERT_FALSE(is_covariance(Mat2(-Mat2::Identity())));
  TEST_ASSERT_FALSE(is_covariance(Mat2(Mat2::Identity() * std::numeric_limits<Scalar>::quiet_NaN())));
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_consensus_should_reject_wrong_matches_when_three_in_ten_are_wrong);
  RUN_TEST(test_consensus_should_keep_as_many_as_the_gate_says_when_all_are_right);
  RUN_TEST(test_consensus_should_find_few_when_all_matches_are_random);
  RUN_TEST(test_consensus_should_take_measurements_of_one_and_of_eight_rows);
  RUN_TEST(test_squared_distance_should_be_that_of_the_inverse_covariance);
  RUN_TEST(test_a_covariance_should_be_none_when_a_distance_cannot_be_computed_from_it);
  return UNITY_END();
}
