// From inverse depth to a 3-D point: the Jacobians, and the measure of how linear the depth is.
#include "observe/inverse_depth.h"
#include "support/filter_cases.h"
#include "support/numeric_jacobian.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

void test_conversion_jacobian_should_be_exact() {
  SeededRandom random(48);
  for (int trial = 0; trial < 100; ++trial) {
    const Vec3 o_W = random.normals<3>(1), p_W = o_W + random.normals<3>(2);
    if ((p_W - o_W).norm() < Scalar(0.5)) continue;
    const InverseDepth feature = inverse_depth_of(random, p_W, o_W);
    Mat3 J, unused;
    const Vec3 f_W = inverse_depth_to_point(o_W, feature, &J);
    TEST_ASSERT_TRUE((f_W - p_W).norm() < (kNumericJacobianIsFloat ? Scalar(1e-5) : Scalar(1e-13)));
    check_jacobian<3, 3>(
        J, [&](const Vec3& e) { return inverse_depth_to_point(o_W, moved(feature, e), &unused); }, "J_f_feature",
        feature.rho * Scalar(0.2));
    check_jacobian<3, 3>(
        Mat3(Mat3::Identity()), [&](const Vec3& e) { return inverse_depth_to_point(o_W + e, feature, &unused); },
        "J_f_o");
  }
}

void test_linearity_index_should_fall_as_the_depth_becomes_known_and_the_view_turns_away() {
  SeededRandom random(49);
  Body body;
  const Vec3 o_W = Vec3::Zero(), p_W(0, 0, 2);
  const InverseDepth feature = inverse_depth_of(random, p_W, o_W);
  // At the first view: 4 sigma_d / d with sigma_d = sigma_rho d^2.
  const Scalar index = linearity_index(body.p_W, o_W, feature, Scalar(0.01));
  TEST_ASSERT_TRUE(std::abs(index - Scalar(0.08)) < Scalar(1e-5));
  TEST_ASSERT_TRUE(linearity_index(body.p_W, o_W, feature, Scalar(0.005)) < index);
  body.p_W = Vec3(2, 0, 2);  // at a right angle to the first ray
  TEST_ASSERT_TRUE(linearity_index(body.p_W, o_W, feature, Scalar(0.01)) < Scalar(1e-5));
}

void test_linearity_index_should_never_allow_a_depth_that_may_be_infinite() {
  SeededRandom random(50);
  const Body body;
  const Vec3 o_W = Vec3::Zero();
  InverseDepth feature = inverse_depth_of(random, Vec3(0, 0, 2), o_W);
  TEST_ASSERT_TRUE(linearity_index(body.p_W, o_W, feature, Scalar(0.3)) > Scalar(1e5));
  feature.rho = 0;
  TEST_ASSERT_TRUE(linearity_index(body.p_W, o_W, feature, Scalar(0)) > Scalar(1e5));
  feature.rho = Scalar(-0.5);
  TEST_ASSERT_TRUE(linearity_index(body.p_W, o_W, feature, Scalar(0.01)) > Scalar(1e5));
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_conversion_jacobian_should_be_exact);
  RUN_TEST(test_linearity_index_should_fall_as_the_depth_becomes_known_and_the_view_turns_away);
  RUN_TEST(test_linearity_index_should_never_allow_a_depth_that_may_be_infinite);
  return UNITY_END();
}
