// A covariance that rounding has spoilt reaches the caller as one, and never as certainty.
#include <cmath>

#include "api/copy.h"
#include "same.h"
#include "support/filter_cases.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

double smallest_correlation(const double* C, int n) {
  Dense A(n, n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const double scale = std::sqrt(C[i * n + i] * C[j * n + j]);
      A(i, j) = scale > 0 ? C[i * n + j] / scale : i == j ? 1 : 0;
    }
  return eigenvalues_of(A)(0);
}

void test_a_sound_covariance_should_be_copied_as_it_is() {
  Mat3 C;
  C << Scalar(4), Scalar(1), Scalar(-0.5), Scalar(1), Scalar(2), Scalar(0.25), Scalar(-0.5), Scalar(0.25), Scalar(1);
  double out[9];
  copy_covariance(C, out);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) TEST_ASSERT_EQUAL_DOUBLE(static_cast<double>(C(i, j)), out[3 * i + j]);
}

void test_a_row_of_zeros_should_stay_exactly_known() {
  Mat3 C = Mat3::Identity();
  C(1, 1) = 0;
  double out[9];
  copy_covariance(C, out);
  TEST_ASSERT_EQUAL_DOUBLE(0.0, out[4]);
  TEST_ASSERT_EQUAL_DOUBLE(1.0, out[0]);
}

void test_a_negative_variance_should_not_read_as_certain() {
  Mat3 C = Mat3::Identity();
  C(1, 1) = Scalar(-0.25);
  double out[9];
  copy_covariance(C, out);
  TEST_ASSERT_EQUAL_DOUBLE(0.25, out[4]);
  TEST_ASSERT_TRUE(smallest_correlation(out, 3) > -1e-8);
}

void test_a_variance_should_be_as_large_as_its_covariances_ask_for() {
  for (const double lost : {0.0, -1e-6}) {
    Mat3 C = Mat3::Identity();
    C(2, 2) = static_cast<Scalar>(lost);
    C(2, 0) = C(0, 2) = Scalar(0.5);
    double out[9];
    copy_covariance(C, out);
    TEST_ASSERT_TRUE(out[8] >= 0.25);
    TEST_ASSERT_TRUE(out[8] < 0.3);
    TEST_ASSERT_TRUE(smallest_correlation(out, 3) > -1e-8);
  }
}

void test_two_lost_variances_with_a_covariance_should_not_read_as_certain() {
  Mat2 C;
  C << Scalar(0), Scalar(0.125), Scalar(0.125), Scalar(-0.0);
  double out[4];
  copy_covariance(C, out);
  TEST_ASSERT_TRUE(out[0] >= 0.125 && out[3] >= 0.125);
  TEST_ASSERT_TRUE(smallest_correlation(out, 2) > -1e-8);
}

void test_what_is_not_finite_should_read_as_unknown() {
  Mat3 C = Mat3::Identity();
  C(1, 0) = C(0, 1) = static_cast<Scalar>(std::nan(""));
  double out[9];
  copy_covariance(C, out);
  TEST_ASSERT_EQUAL_DOUBLE(kMaxVariance, out[0]);
  TEST_ASSERT_EQUAL_DOUBLE(1.0, out[4]);
  TEST_ASSERT_EQUAL_DOUBLE(1.0, out[8]);
  TEST_ASSERT_EQUAL_DOUBLE(0.0, out[1]);
}

void test_two_sides_that_differ_should_become_their_mean() {
  double C[9] = {4, 1, 0, 1 + 2e-9, 2, 0.5, 0, 0.5, 1};
  repair_covariance(C, 3);
  TEST_ASSERT_EQUAL_DOUBLE(1 + 1e-9, C[1]);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < i; ++j) TEST_ASSERT_SAME(C[3 * j + i], C[3 * i + j]);
}

void test_any_symmetric_numbers_should_become_a_covariance() {
  SeededRandom random(14);
  for (int run = 0; run < 2000; ++run) {
    const int n = 1 + run % kMaxCovariance;
    double C[kMaxCovariance * kMaxCovariance];
    for (int i = 0; i < n; ++i)
      for (int j = 0; j <= i; ++j)
        C[i * n + j] = C[j * n + i] = random.uniform(-1, 1) * std::pow(10.0, random.uniform(-12, 6));
    repair_covariance(C, n);
    TEST_ASSERT_TRUE(finite(C, n * n));
    for (int i = 0; i < n; ++i) TEST_ASSERT_TRUE(C[i * n + i] > 0);
    TEST_ASSERT_TRUE(smallest_correlation(C, n) > -1e-8);
  }
}

/// The body and its reference camera share all of their error but for one row, of which rounding has left a difference below zero.
void test_a_motion_should_not_be_certain_when_rounding_took_all_of_it() {
  for (const double missing : {0.0, 0.5, 4.0}) {
    TestFilter filter(true);
    std::vector<Scalar> identity(kBodyRows * kBodyRows, Scalar(0));
    for (int i = 0; i < kBodyRows; ++i) identity[static_cast<std::size_t>(i * (kBodyRows + 1))] = 1;
    filter->set_body(Body(), identity.data());
    const int camera = filter->add_reference_camera();
    Dense P = filter.P();
    const int copy = filter.first(camera);
    const double epsilon = static_cast<double>(std::numeric_limits<Scalar>::epsilon());
    for (int i = 0; i < 6; ++i) P(i, i) = P(copy + i, i) = P(i, copy + i) = P(copy + i, copy + i) = 1;
    P(3, 3) -= missing * epsilon;
    filter.set_P(P);
    Quat q_KC;
    Vec3 p_KC;
    Mat6 covariance;
    filter->motion_since(camera, &q_KC, &p_KC, &covariance);
    double out[36];
    copy_covariance(covariance, out);
    for (int i = 0; i < 6; ++i) TEST_ASSERT_TRUE(out[7 * i] >= epsilon);
    for (int i = 0; i < 6; ++i) TEST_ASSERT_TRUE(out[7 * i] < 20 * epsilon);
  }
}

/// Two rows that are one, up to scale, leave a pivot of zero; what follows may still be indefinite.
void test_an_indefinite_matrix_should_be_no_covariance_behind_a_pivot_of_zero() {
  double P[9] = {1, 1, 0, 1, 1, 0.5, 0, 0.5, 1};
  TEST_ASSERT_FALSE(is_covariance(P, 3));
  P[5] = P[7] = 0;
  TEST_ASSERT_TRUE(is_covariance(P, 3));
  P[5] = P[7] = 1e-3;
  TEST_ASSERT_FALSE(is_covariance(P, 3));
  P[2] = P[6] = 1e-3;
  TEST_ASSERT_TRUE(is_covariance(P, 3));
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_a_sound_covariance_should_be_copied_as_it_is);
  RUN_TEST(test_a_row_of_zeros_should_stay_exactly_known);
  RUN_TEST(test_a_negative_variance_should_not_read_as_certain);
  RUN_TEST(test_a_variance_should_be_as_large_as_its_covariances_ask_for);
  RUN_TEST(test_two_lost_variances_with_a_covariance_should_not_read_as_certain);
  RUN_TEST(test_what_is_not_finite_should_read_as_unknown);
  RUN_TEST(test_two_sides_that_differ_should_become_their_mean);
  RUN_TEST(test_any_symmetric_numbers_should_become_a_covariance);
  RUN_TEST(test_a_motion_should_not_be_certain_when_rounding_took_all_of_it);
  RUN_TEST(test_an_indefinite_matrix_should_be_no_covariance_behind_a_pivot_of_zero);
  return UNITY_END();
}
