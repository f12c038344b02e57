// A covariance that is none is found within a few frames, and becomes one; one that is sound stays as it is.
#include <cstring>

#include "filter/tuning.h"
#include "same.h"
#include "support/filter_scene.h"
#include "support/slow_walk.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr int kTurns = 40;  // in which every row has been looked at with the body

/// Correlations with one eigenvalue of this size, of rows that are all equally known.
Dense with_eigenvalue(SeededRandom& random, int n, double smallest) {
  Dense vectors;
  Eigen::VectorXd values = eigenvalues_of(random_covariance(random, n, 1), &vectors);
  values(0) = smallest * values(n - 1);
  return vectors * values.asDiagonal() * vectors.transpose();
}

void test_a_sound_covariance_should_stay_bit_for_bit() {
  SeededRandom random(91);
  TestFilter filter(true);
  fill_map(random, filter, 5, 6);
  filter.set_P(random_covariance(random, filter.dim(), 0.1));
  const std::vector<Scalar> before = bits_of(filter);
  for (int turn = 0; turn < kTurns; ++turn) TEST_ASSERT_SAME(BlockFilter::Repair::kNone, filter->repair(turn));
  const std::vector<Scalar> after = bits_of(filter);
  TEST_ASSERT_EQUAL_INT(0, std::memcmp(before.data(), after.data(), before.size() * sizeof(Scalar)));
}

void test_a_negative_eigenvalue_should_be_repaired() {
  SeededRandom random(92);
  for (const double smallest : {-0.5, -0.01, -1e-3}) {
    TestFilter filter(true);  // few enough rows for one sample
    fill_map(random, filter, 2, 2);
    TEST_ASSERT_TRUE(filter.dim() <= tuning::soundness::kSample);
    filter.set_P(with_eigenvalue(random, filter.dim(), smallest));
    const double largest_before = filter.P().diagonal().maxCoeff();
    const double found = slow_walk::smallest_correlation(filter->covariance());
    TEST_ASSERT_TRUE(found < -1e-4);
    TEST_ASSERT_SAME(BlockFilter::Repair::kDone, filter->repair(0));
    TEST_ASSERT_TRUE(slow_walk::smallest_correlation(filter->covariance()) > -1e-6);
    TEST_ASSERT_SAME(BlockFilter::Repair::kNone, filter->repair(1));
    // By no more than the step beyond what was missing.
    TEST_ASSERT_TRUE(filter.P().diagonal().maxCoeff() <= largest_before * (1 + 5 * std::fabs(found) + 1e-3));
  }
}

void test_what_two_far_rows_hold_should_be_found_in_time() {
  SeededRandom random(93);
  TestFilter filter(true);
  fill_map(random, filter, 12, 12);
  TEST_ASSERT_TRUE(filter.dim() > tuning::soundness::kSample);
  Dense P = Dense::Identity(filter.dim(), filter.dim());
  P(0, filter.dim() - 1) = P(filter.dim() - 1, 0) = 1.5;  // a row of the body and the last one
  filter.set_P(P);
  int repaired = 0;
  for (int turn = 0; turn < kTurns; ++turn) repaired += filter->repair(turn) == BlockFilter::Repair::kDone ? 1 : 0;
  TEST_ASSERT_TRUE(repaired > 0);
  TEST_ASSERT_TRUE(slow_walk::smallest_correlation(filter->covariance()) > -1e-4);
}

/// Of a map with few rows, in float: each share rounds to nothing beside 1.
void test_small_growth_should_add_up() {
  SeededRandom random(95);
  TestFilter filter(true);
  fill_map(random, filter, 5, 6);
  filter.set_P(random_covariance(random, filter.dim(), 0.1));
  const Eigen::VectorXd before = filter.P().diagonal();
  for (int k = 0; k < 200; ++k) const_cast<BlockFilter&>(filter->blocks()).grow(Scalar(4e-8));
  const Eigen::VectorXd growth = filter.P().diagonal().cwiseQuotient(before).array() - 1;
  TEST_ASSERT_TRUE(growth.minCoeff() > 4e-6);
  TEST_ASSERT_TRUE(growth.maxCoeff() < 16e-6);
}

/// A pose of which hardly anything was known is seen to a part in a million and better: what float leaves of its variances is rounding.
void test_an_update_should_leave_variances_where_rounding_takes_most() {
  SeededRandom random(96);
  int taken = 0;
  for (int trial = 0; trial < 40; ++trial) {
    Scene scene(random, false);
    Dense P = Dense::Identity(scene.filter.dim(), scene.filter.dim()) * 1e-14;
    for (int i = 0; i < 6; ++i) P(i, i) = std::pow(10, random.uniform(-2, 1));
    scene.filter.set_P(P);
    for (PixelMeasurement& o : scene.observations) {
      const Vec2 measured = o.predicted;
      TEST_ASSERT_TRUE(scene.filter->predict_pixel(pinhole_camera(), o.block, &o));
      o.measured = measured;
      o.set_noise(Mat2(Mat2::Identity() * Scalar(0.3)));
    }
    scene.filter->begin_update(scene.observations.data(), scene.count());
    if (!scene.filter->finish_update(scene.observations.data(), scene.count(), nullptr, nullptr)) continue;
    ++taken;
    const Eigen::VectorXd left = scene.filter.P().diagonal().cwiseQuotient(P.diagonal()).head(6);
    TEST_ASSERT_TRUE(left.minCoeff() > (sizeof(Scalar) == sizeof(float) ? 4e-7 : 0));
    TEST_ASSERT_TRUE(scene.filter.P().diagonal().head(6).maxCoeff() < 1e-4);
  }
  TEST_ASSERT_TRUE(taken > 20);
}

void test_what_is_not_finite_should_not_be_repaired() {
  SeededRandom random(94);
  TestFilter filter(true);
  fill_map(random, filter, 2, 2);
  Dense P = random_covariance(random, filter.dim(), 0.1);
  P(1, 0) = P(0, 1) = std::nan("");
  filter.set_P(P);
  TEST_ASSERT_SAME(BlockFilter::Repair::kImpossible, filter->repair(0));
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_a_sound_covariance_should_stay_bit_for_bit);
  RUN_TEST(test_a_negative_eigenvalue_should_be_repaired);
  RUN_TEST(test_what_two_far_rows_hold_should_be_found_in_time);
  RUN_TEST(test_small_growth_should_add_up);
  RUN_TEST(test_an_update_should_leave_variances_where_rounding_takes_most);
  RUN_TEST(test_what_is_not_finite_should_not_be_repaired);
  return UNITY_END();
}
