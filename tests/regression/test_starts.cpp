// Faults that a start once had.
#include <cmath>

#include "geometry/symmetric_eigen.h"
#include "observe/inverse_depth.h"
#include "support/small_context.h"

static void test_control_input_before_the_first_pose_should_have_no_effect() {
  double p[2][3];
  for (int pushed = 0; pushed < 2; ++pushed) {
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_reset(slam));
    const double dv_C[3] = {pushed * 5.0, 0, 0}, dw_C[3] = {0, pushed * 2.0, 0};
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_push_control(slam, dv_C, dw_C));
    run(slam, 3);
    pf_pose_t pose;
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_pose(slam, &pose));
    std::memcpy(p[pushed], pose.p_WC, sizeof pose.p_WC);
  }
  TEST_ASSERT_EQUAL_MEMORY(p[0], p[1], sizeof p[0]);
}

// A depth that is not known to be finite was once reported with a covariance of zero.
static void test_a_point_without_a_positive_depth_should_not_be_reported_as_known() {
  using pf::Scalar;
  pf::Mat6 covariance = pf::Mat6::Zero();
  covariance(5, 5) = Scalar(1e-10);
  pf::InverseDepth feature{pf::Quat::Identity(), Scalar(0)};
  for (const Scalar rho : {Scalar(-0.2), Scalar(0), Scalar(1e-4), Scalar(9e-4)}) {
    feature.rho = rho;
    pf::Mat3 C;
    const pf::Vec3 f_W = pf::shown_place(pf::Vec3::Zero(), feature, covariance, &C);
    TEST_ASSERT_TRUE(std::fabs(static_cast<double>(f_W.z()) - 1000) < 1e-2);
    // At least as far as the shown depth is from what the estimate says, to first order: 1e6 (1e-3 - rho).
    TEST_ASSERT_TRUE(static_cast<double>(std::sqrt(C(2, 2))) > 0.99e6 * (1e-3 - static_cast<double>(rho)));
  }
  feature.rho = Scalar(0.5);
  pf::Mat3 C;
  pf::shown_place(pf::Vec3::Zero(), feature, covariance, &C);
  TEST_ASSERT_TRUE(std::fabs(static_cast<double>(std::sqrt(C(2, 2))) - 4e-5) < 1e-7);
}

static void test_the_larger_eigenvalue_should_not_be_smaller_than_along_a_slanted_axis() {
  pf::Mat2 S;
  S << 1, pf::Scalar(0.9), pf::Scalar(0.9), 1;
  const pf::Vec2 lambda = pf::symmetric_eigenvalues(S);
  TEST_ASSERT_TRUE(std::fabs(static_cast<double>(lambda(1)) - 1.9) < 1e-6);
  TEST_ASSERT_TRUE(std::fabs(static_cast<double>(lambda(0)) - 0.1) < 1e-6);
}

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_control_input_before_the_first_pose_should_have_no_effect);
  RUN_TEST(test_a_point_without_a_positive_depth_should_not_be_reported_as_known);
  RUN_TEST(test_the_larger_eigenvalue_should_not_be_smaller_than_along_a_slanted_axis);
  return UNITY_END();
}
