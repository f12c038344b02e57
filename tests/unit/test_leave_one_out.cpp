// One match against all the others: as brute force says, and what moves is found although its depth is open.
#include "filter_slam/pose/consensus.h"
#include "filter_slam/pose/leave_one_out.h"
#include "support/filter_scene.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr int kMatches = 40;
constexpr double kTolerance = sizeof(Scalar) == 8 ? 1e-6 : 1e-2;
constexpr Scalar kGate = Scalar(13.8155);  // 99.9 % with two degrees of freedom

struct Tester {
  std::vector<double> block = std::vector<double>(20000);
  LeaveOneOut others;

  Tester() {
    Arena arena(block.data(), block.size() * sizeof(double));
    TEST_ASSERT_TRUE(others.layout(arena, kMatches));
  }
};

/// A map seen by a camera, all uncertain, and one match of each feature with errors as the joint covariance has them.
struct Matches {
  TestFilter filter{true};
  std::vector<PixelMeasurement> observation;
  Dense S;

  /// open: the camera's direction is hardly known, and inverse depths not at all.
  Matches(SeededRandom& random, int points, int inverse, bool open = false) {
    const std::vector<int> slots = fill_map(random, filter, points, inverse);
    Dense P = random_covariance(random, filter.dim(), open ? 0.0005 : 0.003);
    if (open) {
      P.block(Body::kTheta, Body::kTheta, 3, 3) += 0.01 * 0.01 * Dense::Identity(3, 3);
      for (std::size_t i = static_cast<std::size_t>(points); i < slots.size(); ++i) {
        const int rho = filter.first(slots[i]) + 2;
        P.row(rho).setZero();
        P.col(rho).setZero();
        P(rho, rho) = 0.25;
      }
    }
    filter.set_P(P);
    for (const int slot : slots) {
      PixelMeasurement o;
      TEST_ASSERT_TRUE(filter->predict_pixel(pinhole_camera(), slot, &o));
      o.set_noise(Mat2::Identity() * Scalar(0.04));
      observation.push_back(o);
    }
    filter->begin_update(observation.data(), count());
    S.resize(2 * count(), 2 * count());
    for (int i = 0; i < count(); ++i)
      for (int j = 0; j < count(); ++j) {
        Mat2 block = filter->innovation_block(i, j);
        if (i == j) block += at(i).R_gate;
        S.block(2 * i, 2 * j, 2, 2) = block.cast<double>();
      }
    const Dense L = lower_factor(S);
    Eigen::VectorXd white(2 * count());
    for (int i = 0; i < white.size(); ++i) white(i) = random.normal();
    const Eigen::VectorXd r = L * white;
    for (int i = 0; i < count(); ++i) {
      PixelMeasurement& o = at(i);
      o.measured = o.predicted + r.segment<2>(2 * i).cast<Scalar>();
    }
  }
  PixelMeasurement& at(int i) { return observation[static_cast<std::size_t>(i)]; }
  int count() const { return static_cast<int>(observation.size()); }

  /// Of the kept ones' S.
  double log_det(const std::vector<unsigned char>& keep) {
    std::vector<int> rows;
    for (int i = 0; i < count(); ++i)
      if (keep[static_cast<std::size_t>(i)] != 0) rows.insert(rows.end(), {2 * i, 2 * i + 1});
    const Dense L = lower_factor(S(rows, rows));
    return 2 * L.diagonal().array().log().sum();
  }

  /// Innovation and covariance of match `left` (none: -1) given the other kept ones, by a solution of its own.
  double distance(int left, const std::vector<unsigned char>& keep) {
    std::vector<int> rows;
    for (int i = 0; i < count(); ++i)
      if (keep[static_cast<std::size_t>(i)] != 0 && i != left) rows.insert(rows.end(), {2 * i, 2 * i + 1});
    Eigen::VectorXd r(2 * count());
    for (int i = 0; i < count(); ++i) r.segment<2>(2 * i) = (at(i).measured - at(i).predicted).cast<double>();
    const Dense inverse = inverse_of(S(rows, rows));
    const Eigen::VectorXd r_rest = r(rows);
    if (left < 0) return r_rest.dot(inverse * r_rest);
    const std::vector<int> own = {2 * left, 2 * left + 1};
    const Dense gain = S(own, rows) * inverse;
    const Eigen::VectorXd e = r(own) - gain * r_rest;
    const Dense C = S(own, own) - gain * S(rows, own);
    return e.dot(C.inverse() * e);
  }
};

void test_rejection_should_be_that_of_one_match_at_a_time_by_brute_force() {
  SeededRandom random(41);
  Tester tester;
  int rejected = 0;
  for (int trial = 0; trial < 20; ++trial) {
    Matches m(random, 12, 8);
    for (int k = 0; k < trial % 5; ++k) m.at(3 * k + 1).measured += random.normals<2>(3);
    std::vector<unsigned char> expected(static_cast<std::size_t>(m.count()), 1);
    expected[0] = 0;  // as the consensus left it
    std::vector<unsigned char> keep = expected;
    for (;;) {
      int worst = -1;
      double largest = static_cast<double>(kGate);
      for (int i = 0; i < m.count(); ++i) {
        const double d2 = expected[static_cast<std::size_t>(i)] != 0 ? m.distance(i, expected) : 0;
        if (!(d2 > largest)) continue;
        largest = d2;
        worst = i;
      }
      if (worst < 0) break;
      expected[static_cast<std::size_t>(worst)] = 0;
      ++rejected;
    }
    JointFit fit;
    TEST_ASSERT_TRUE(tester.others.reject(*m.filter, m.observation.data(), m.count(), kGate, {}, keep.data(), &fit));
    for (int i = 0; i < m.count(); ++i)
      TEST_ASSERT_EQUAL_INT(expected[static_cast<std::size_t>(i)], keep[static_cast<std::size_t>(i)]);
    const double exact = m.distance(-1, expected);
    TEST_ASSERT_TRUE(std::fabs(static_cast<double>(fit.nis) - exact) < kTolerance * (1 + exact));
    TEST_ASSERT_DOUBLE_WITHIN(kTolerance * 100, m.log_det(expected), static_cast<double>(fit.log_det));
  }
  std::printf("%d rejected\n", rejected);
  TEST_ASSERT_GREATER_THAN_INT(20, rejected);
}

void test_matches_should_be_kept_as_the_gate_says_when_all_are_right() {
  SeededRandom random(42);
  Tester tester;
  int kept = 0, all = 0;
  double nis_sum = 0;
  for (int trial = 0; trial < 100; ++trial) {
    Matches m(random, 12, 8);
    std::vector<unsigned char> keep(static_cast<std::size_t>(m.count()), 1);
    JointFit fit;
    TEST_ASSERT_TRUE(tester.others.reject(*m.filter, m.observation.data(), m.count(), kGate, {}, keep.data(), &fit));
    for (const unsigned char k : keep) kept += k;
    all += m.count();
    nis_sum += static_cast<double>(fit.nis);
  }
  std::printf("kept %.4f, NIS per degree of freedom %.3f\n", kept / double(all), nis_sum / (2 * kept));
  TEST_ASSERT_TRUE(kept >= 0.997 * all);
  TEST_ASSERT_TRUE(std::fabs(nis_sum / (2 * kept) - 1) < 0.06);
}

/// A feature moves across the direction in which its depth would move it. It stays within its own ellipse, since the camera's direction is
/// uncertain; all the others together leave it the epipolar line.
void test_a_moving_feature_should_be_rejected_when_its_depth_is_open() {
  SeededRandom random(43);
  Tester tester;
  int caught = 0, kept = 0, within = 0;
  constexpr int kTrials = 40;
  for (int trial = 0; trial < kTrials; ++trial) {
    Matches m(random, 24, 1, true);
    const int young = m.count() - 1;
    PixelMeasurement& o = m.at(young);
    const int columns = o.H.columns();
    const Vec2 along = Vec2(o.H.h[columns - 1], o.H.h[2 * columns - 1]).normalized();
    o.measured += 3 * Vec2(-along.y(), along.x());
    within += squared_distance(o.measured - o.predicted, m.S.block<2, 2>(2 * young, 2 * young).cast<Scalar>()) < kGate;
    std::vector<unsigned char> keep(static_cast<std::size_t>(m.count()), 1);
    JointFit fit;
    TEST_ASSERT_TRUE(tester.others.reject(*m.filter, m.observation.data(), m.count(), kGate, {}, keep.data(), &fit));
    caught += 1 - keep[static_cast<std::size_t>(young)];
    for (int i = 0; i < young; ++i) kept += keep[static_cast<std::size_t>(i)];
  }
  std::printf("%d of %d within their ellipses, caught %d, kept %d of %d others\n", within, kTrials, caught, kept,
              24 * kTrials);
  TEST_ASSERT_GREATER_OR_EQUAL_INT(kTrials - 4, within);
  TEST_ASSERT_GREATER_OR_EQUAL_INT(kTrials - 4, caught);
  TEST_ASSERT_TRUE(kept >= 0.99 * 24 * kTrials);
}

/// Young features that all move by the same few pixels support each other: hardly one of them is rejected by itself.
void test_a_group_of_young_features_should_be_rejected_when_the_older_ones_contradict_it() {
  SeededRandom random(45);
  Tester tester;
  constexpr int kTrials = 40, kPoints = 16, kYoung = 12, kAll = kPoints + kYoung;
  unsigned char ages[kAll];
  for (int i = 0; i < kAll; ++i) ages[i] = static_cast<unsigned char>(i < kPoints ? 30 : 1 + i % 3);
  int alone = 0, group = 0, older = 0, still = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    Matches m(random, kPoints, kYoung, true);
    const std::vector<unsigned char> all(kAll, 1);
    JointFit fit;
    std::vector<unsigned char> keep = all;
    TEST_ASSERT_TRUE(
        tester.others.reject(*m.filter, m.observation.data(), m.count(), kGate, {ages, 8}, keep.data(), &fit));
    for (int i = kPoints; i < kAll; ++i) still += keep[static_cast<std::size_t>(i)];
    for (int i = kPoints; i < kAll; ++i) {
      const int columns = m.at(i).H.columns();
      const Vec2 along = Vec2(m.at(i).H.h[columns - 1], m.at(i).H.h[2 * columns - 1]).normalized();
      m.at(i).measured += Scalar(1.2) * Vec2(-along.y(), along.x());
    }
    keep = all;
    TEST_ASSERT_TRUE(tester.others.reject(*m.filter, m.observation.data(), m.count(), kGate, {}, keep.data(), &fit));
    for (int i = kPoints; i < kAll; ++i) alone += keep[static_cast<std::size_t>(i)];
    keep = all;
    TEST_ASSERT_TRUE(
        tester.others.reject(*m.filter, m.observation.data(), m.count(), kGate, {ages, 8}, keep.data(), &fit));
    const std::vector<unsigned char> left = keep;
    const double exact = m.distance(-1, left);
    TEST_ASSERT_TRUE(std::fabs(static_cast<double>(fit.nis) - exact) < kTolerance * (1 + exact));
    TEST_ASSERT_DOUBLE_WITHIN(kTolerance * 100, m.log_det(left), static_cast<double>(fit.log_det));
    for (int i = 0; i < kAll; ++i) (i < kPoints ? older : group) += keep[static_cast<std::size_t>(i)];
  }
  std::printf(
      "young ones kept: %d at rest, %d moving without the test of groups, %d with it, of %d; older ones %d of %d\n",
      still, alone, group, kTrials * kYoung, older, kTrials * kPoints);
  TEST_ASSERT_TRUE(still >= 0.97 * kTrials * kYoung);
  TEST_ASSERT_TRUE(alone >= 0.5 * kTrials * kYoung);
  TEST_ASSERT_TRUE(group <= 0.1 * kTrials * kYoung);
  TEST_ASSERT_TRUE(older >= 0.99 * kTrials * kPoints);
}

void test_nothing_should_change_when_there_is_nothing_to_test() {
  SeededRandom random(44);
  Tester tester;
  Matches m(random, 5, 0);
  std::vector<unsigned char> keep(5, 0);
  JointFit fit;
  fit.nis = 7;
  fit.log_det = 8;
  TEST_ASSERT_FALSE(tester.others.reject(*m.filter, m.observation.data(), m.count(), kGate, {}, keep.data(), &fit));
  TEST_ASSERT_TRUE(fit.nis == Scalar(7) && fit.log_det == Scalar(8));
  keep[2] = 1;  // one match has no others: its own ellipse
  m.at(2).measured = m.at(2).predicted + Vec2(Scalar(1000), Scalar(0));
  TEST_ASSERT_TRUE(tester.others.reject(*m.filter, m.observation.data(), m.count(), kGate, {}, keep.data(), &fit));
  TEST_ASSERT_EQUAL_INT(0, keep[2]);
  TEST_ASSERT_TRUE(fit.nis >= Scalar(0) && fit.nis < Scalar(1e-3));
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_rejection_should_be_that_of_one_match_at_a_time_by_brute_force);
  RUN_TEST(test_matches_should_be_kept_as_the_gate_says_when_all_are_right);
  RUN_TEST(test_a_moving_feature_should_be_rejected_when_its_depth_is_open);
  RUN_TEST(test_a_group_of_young_features_should_be_rejected_when_the_older_ones_contradict_it);
  RUN_TEST(test_nothing_should_change_when_there_is_nothing_to_test);
  return UNITY_END();
}
