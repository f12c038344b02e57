// Rotations by pictures and by a gyro: the chain against dense least squares, and its errors against their stated variance.
#include <cmath>

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

Quat truth(int k) {
  const double t = 0.1 * k;
  return exp_so3(
      Vec3(Scalar(0.8 * std::sin(1.3 * t)), Scalar(1.1 * std::sin(0.9 * t + 1)), Scalar(0.6 * std::sin(2.1 * t))));
}

void draw(SeededRandom& random, RotationLink* link) {
  for (int k = 0; k < kLinks; ++k) {
    const double sigma = kPicture * (1 + k % 3);
    link[k] = RotationLink();
    link[k].q_WC = exp_so3(random.normals<3>(sigma)) * truth(k);
    link[k].variance = Scalar(sigma * sigma);
    if (k > 0) link[k].dq = truth(k - 1).conjugate() * truth(k) * exp_so3(random.normals<3>(kStep));
    link[k].step_variance = Scalar(kStep * kStep);
  }
}

void test_the_chain_should_solve_the_least_squares_of_all_links() {
  SeededRandom random(341);
  RotationLink link[kLinks];
  draw(random, link);
  using Matrix = Eigen::Matrix<double, kLinks, kLinks>;
  Matrix A = Matrix::Zero();
  Eigen::Matrix<double, kLinks, 3> b = Eigen::Matrix<double, kLinks, 3>::Zero();
  Quat chain[kLinks];
  for (int k = 0; k < kLinks; ++k) {
    chain[k] = k == 0 ? link[0].q_WC : chain[k - 1] * link[k].dq;
    const double w = 1 / static_cast<double>(link[k].variance);
    A(k, k) += w;
    b.row(k) = w * log_so3(link[k].q_WC * chain[k].conjugate()).cast<double>().transpose();
    if (k == 0) continue;
    const double s = 1 / static_cast<double>(link[k].step_variance);
    A(k, k) += s;
    A(k - 1, k - 1) += s;
    A(k, k - 1) -= s;
    A(k - 1, k) -= s;
  }
  const Matrix inverse = A.inverse();
  const Eigen::Matrix<double, kLinks, 3> x = inverse * b;
  smooth_rotations(link, kLinks);
  for (int k = 0; k < kLinks; ++k) {
    const Vec3 expected = x.row(k).transpose().cast<Scalar>();
    const Quat q = exp_so3(expected) * chain[k];
    TEST_ASSERT_TRUE(log_so3(link[k].q_WC * q.conjugate()).norm() < Scalar(2e-6));
    TEST_ASSERT_TRUE(std::fabs(static_cast<double>(link[k].variance) / inverse(k, k) - 1) < 1e-3);
  }
}

void test_errors_should_be_as_large_as_stated_and_smaller_than_those_of_pictures() {
  SeededRandom random(342);
  constexpr int kDraws = 100;
  double nees = 0, squares = 0;
  for (int i = 0; i < kDraws; ++i) {
    RotationLink link[kLinks];
    draw(random, link);
    smooth_rotations(link, kLinks);
    for (int k = 0; k < kLinks; ++k) {
      const double e2 = static_cast<double>(log_so3(link[k].q_WC * truth(k).conjugate()).squaredNorm());
      nees += e2 / static_cast<double>(link[k].variance) / (kDraws * kLinks);
      squares += e2 / (3 * kDraws * kLinks);
    }
  }
  if (!(nees > 2.7 && nees < 3.3)) std::printf("NEES %.2f of 3, rms %.6f rad\n", nees, std::sqrt(squares));
  TEST_ASSERT_TRUE(nees > 2.7 && nees < 3.3);
  TEST_ASSERT_TRUE(std::sqrt(squares) < 0.6 * kPicture);
}

void test_one_link_should_stay_what_its_picture_says() {
  RotationLink link;
  link.q_WC = truth(3);
  link.variance = Scalar(4e-6);
  smooth_rotations(&link, 1);
  TEST_ASSERT_TRUE(log_so3(link.q_WC * truth(3).conjugate()).norm() < Scalar(1e-6));
  TEST_ASSERT_TRUE(std::abs(link.variance / Scalar(4e-6) - 1) < Scalar(1e-5));
  smooth_rotations(&link, 0);
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_the_chain_should_solve_the_least_squares_of_all_links);
  RUN_TEST(test_errors_should_be_as_large_as_stated_and_smaller_than_those_of_pictures);
  RUN_TEST(test_one_link_should_stay_what_its_picture_says);
  return UNITY_END();
}
