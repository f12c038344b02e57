// Rotations by pictures and by a gyro with a bias: the chain against dense least squares, and its errors against their stated variance.
#include <cmath>
#include <cstdio>

#include "geometry/rotation_smoother.h"
#include "geometry/so3.h"
#include "support/seeded_random.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr int kLinks = 20;
constexpr double kPicture = 5e-4, kStep = 5e-5;  // [rad]
constexpr double kInterval = 0.1, kBias = 0.02;  // [s], [rad/s]

Quat truth(int k) {
  const double t = kInterval * k;
  return exp_so3(
      Vec3(Scalar(0.8 * std::sin(1.3 * t)), Scalar(1.1 * std::sin(0.9 * t + 1)), Scalar(0.6 * std::sin(2.1 * t))));
}

/// Links with a gyro's bias; returns it.
Vec3 draw(SeededRandom& random, RotationLink* link) {
  const Vec3 bias = random.normals<3>(kBias);
  for (int k = 0; k < kLinks; ++k) {
    const double sigma = kPicture * (1 + k % 3);
    link[k] = RotationLink();
    link[k].q_WC = exp_so3(random.normals<3>(sigma)) * truth(k);
    link[k].variance = Scalar(sigma * sigma);
    link[k].step_variance = Scalar(kStep * kStep);
    link[k].by_bias = Mat3::Identity() * Scalar(-kInterval);
    if (k > 0)
      link[k].dq = truth(k - 1).conjugate() * truth(k) * exp_so3(Vec3(link[k].by_bias * -bias)) *
                   exp_so3(random.normals<3>(kStep));
  }
  return bias;
}

void test_the_chain_should_solve_the_least_squares_of_all_links() {
  SeededRandom random(341);
  RotationLink link[kLinks];
  draw(random, link);
  constexpr int kRows = 3 * kLinks + 3;
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(kRows, kRows);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(kRows);
  A.bottomRightCorner<3, 3>() = Eigen::Matrix3d::Identity() / (kBias * kBias);
  Quat chain[kLinks];
  Eigen::MatrixXd at[kLinks];  // of e_k + C_k b
  Mat3 C = Mat3::Zero();
  for (int k = 0; k < kLinks; ++k) {
    chain[k] = k == 0 ? link[0].q_WC : chain[k - 1] * link[k].dq;
    if (k > 0) C += chain[k].toRotationMatrix() * link[k].by_bias;
    at[k] = Eigen::MatrixXd::Zero(3, kRows);
    at[k].block<3, 3>(0, 3 * k).setIdentity();
    at[k].rightCols<3>() = C.cast<double>();
    const double w = 1 / static_cast<double>(link[k].variance);
    A += w * at[k].transpose() * at[k];
    b += w * at[k].transpose() * log_so3(link[k].q_WC * chain[k].conjugate()).cast<double>();
    if (k == 0) continue;
    Eigen::MatrixXd step = Eigen::MatrixXd::Zero(3, kRows);
    step.block<3, 3>(0, 3 * k).setIdentity();
    step.block<3, 3>(0, 3 * k - 3) = -Eigen::Matrix3d::Identity();
    A += step.transpose() * step / static_cast<double>(link[k].step_variance);
  }
  const Eigen::MatrixXd inverse = A.inverse();
  const Eigen::VectorXd x = inverse * b;
  const Vec3 bias = smooth_rotations(link, kLinks, Scalar(kBias * kBias));
  TEST_ASSERT_TRUE((bias.cast<double>() - x.tail<3>()).norm() < 2e-5);
  for (int k = 0; k < kLinks; ++k) {
    const Vec3 expected = (at[k] * x).cast<Scalar>();
    TEST_ASSERT_TRUE(log_so3(link[k].q_WC * (exp_so3(expected) * chain[k]).conjugate()).norm() < Scalar(5e-6));
    const double variance = (at[k] * inverse * at[k].transpose()).trace() / 3;
    TEST_ASSERT_TRUE(std::fabs(static_cast<double>(link[k].variance) / variance - 1) < 1e-2);
  }
}

void test_errors_should_be_as_large_as_stated_and_smaller_than_those_of_pictures() {
  SeededRandom random(342);
  constexpr int kDraws = 100;
  double nees = 0, squares = 0, of_bias = 0;
  for (int i = 0; i < kDraws; ++i) {
    RotationLink link[kLinks];
    const Vec3 bias = draw(random, link);
    of_bias += static_cast<double>((smooth_rotations(link, kLinks, Scalar(kBias * kBias)) - bias).squaredNorm()) /
               (3 * kDraws);
    for (int k = 0; k < kLinks; ++k) {
      const double e2 = static_cast<double>(log_so3(link[k].q_WC * truth(k).conjugate()).squaredNorm());
      nees += e2 / static_cast<double>(link[k].variance) / (kDraws * kLinks);
      squares += e2 / (3 * kDraws * kLinks);
    }
  }
  if (!(nees > 2.7 && nees < 3.3))
    std::printf("NEES %.2f of 3, rms %.6f rad, bias %.6f rad/s\n", nees, std::sqrt(squares), std::sqrt(of_bias));
  TEST_ASSERT_TRUE(nees > 2.7 && nees < 3.3);
  TEST_ASSERT_TRUE(std::sqrt(squares) < 0.8 * kPicture);
  TEST_ASSERT_TRUE(std::sqrt(of_bias) < 0.05 * kBias);
}

void test_one_link_should_stay_what_its_picture_says() {
  RotationLink link;
  link.q_WC = truth(3);
  link.variance = Scalar(4e-6);
  smooth_rotations(&link, 1, Scalar(1e-4));
  TEST_ASSERT_TRUE(log_so3(link.q_WC * truth(3).conjugate()).norm() < Scalar(1e-6));
  TEST_ASSERT_TRUE(std::abs(link.variance / Scalar(4e-6) - 1) < Scalar(1e-5));
  smooth_rotations(&link, 0, Scalar(1e-4));
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_the_chain_should_solve_the_least_squares_of_all_links);
  RUN_TEST(test_errors_should_be_as_large_as_stated_and_smaller_than_those_of_pictures);
  RUN_TEST(test_one_link_should_stay_what_its_picture_says);
  return UNITY_END();
}
