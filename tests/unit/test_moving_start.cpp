// Scale, gravity and the accelerometer's bias from poses up to scale and exact samples of a moving unit, and from noisy ones.
#include <cmath>
#include <vector>

#include "filter/moving_start.h"
#include "geometry/so3.h"
#include "support/inertial_cases.h"
#include "support/seeded_random.h"
#include "unity.h"
// After the library's own settings of Eigen.
#include <Eigen/Eigenvalues>

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr double kRate = 300, kSigma = 5e-4, kGravity = 9.81, kForce = 2e-3, kSpeed = 1e-3;

/// A hand that waves a unit about; W is turned against gravity. even: at constant velocity, which tells no scale. from_rest: it begins to
/// move at the first pose.
struct Clip {
  Mat3 R_WC(double t) const {
    return exp_so3(Vec3(Scalar(0.3 * std::sin(1.3 * t)), Scalar(0.4 * std::sin(0.9 * t + 1)),
                        Scalar(0.2 * std::sin(2.1 * t))))
        .toRotationMatrix();
  }
  Vec3 p_B(double t) const {
    if (even) return Vec3(Scalar(0.5 * t), Scalar(0.1 * t), 0);
    if (from_rest && t < 0) return Vec3::Zero();
    if (from_rest)
      return Scalar(0.1 * reach * (1 - std::cos(4 * t))) * Vec3(1, Scalar(0.7), Scalar(0.5 * std::sin(2 * t)));
    return Scalar(reach) *
           Vec3(Scalar(0.3 * std::sin(2 * t)), Scalar(0.2 * std::cos(3 * t)), Scalar(0.4 * t + 0.1 * std::sin(4 * t)));
  }
  ImuReading reading(double t) const {
    constexpr double h = 1e-3;
    const Mat3 R = R_WC(t) * R_CB;
    ImuReading r;
    r.gyro = log_so3(Quat(Mat3((R_WC(t - h) * R_CB).transpose() * (R_WC(t + h) * R_CB)))) / Scalar(2 * h);
    const Vec3 a = (p_B(t + h) + p_B(t - h) - 2 * p_B(t)) / Scalar(h * h);
    r.accel = by_force * (R.transpose() * (a - Scalar(kGravity) * down)) + bias;
    return r;
  }
  /// interval: 0.1 s or 1 / 30 s.
  std::vector<MovingPose> poses(int count, double interval, double sigma_p, SeededRandom& random) const {
    std::vector<MovingPose> out;
    for (int k = 0; k < count; ++k) {
      const double t = k * interval;
      MovingPose pose;
      pose.sigma = Scalar(kSigma);
      pose.m_W = R_WC(t) * m_C;
      pose.p_W = (p_B(t) - pose.m_W) / scale + random.normals<3>(sigma_p);
      if (k > 0) {
        Preintegral sum(kUnitNoise, Vec3::Zero(), Vec3::Zero());
        const double from = t - interval, dt = 1 / kRate;
        for (int i = 0; i < static_cast<int>(std::lround(interval * kRate)); ++i)
          sum.add(static_cast<Scalar>(dt), reading(from + i * dt), reading(from + (i + 1) * dt));
        const Mat3 R =
            exp_so3(Vec3(turn * Scalar(from - (count - 1) * interval / 2))).toRotationMatrix() * R_WC(from) * R_CB;
        pose.dt = static_cast<Scalar>(interval);
        pose.Rv = R * sum.v();
        pose.Rp = R * sum.p();
        pose.Rv_b = R * sum.by_bias().block<3, 3>(3, 3);
        pose.Rp_b = R * sum.by_bias().block<3, 3>(6, 3);
      }
      out.push_back(pose);
    }
    return out;
  }

  /// Of a second before the first of poses that last T.
  MovingRest rest(double T, SeededRandom& random) const {
    const Mat3 R_true = R_WC(0) * R_CB, R_WB = exp_so3(Vec3(turn * Scalar(-T / 2))).toRotationMatrix() * R_true;
    MovingRest out;
    out.f_W = R_WB * (R_true.transpose() * Vec3(Scalar(-kGravity) * down) + bias + random.normals<3>(kForce));
    out.f_b = -R_WB;
    out.sigma_force = Scalar(kForce);
    out.sigma_speed = Scalar(kSpeed);
    return out;
  }

  bool even = false, from_rest = false;
  double reach = 1;                  ///< of the hand
  Vec3 turn = Vec3::Zero();          ///< of the poses' rotations, away from the truth [rad/s]
  Mat3 by_force = Mat3::Identity();  ///< readings, beside their bias
  Scalar scale = Scalar(2.5);
  Vec3 down = Vec3(Scalar(0.2), Scalar(0.9), Scalar(-0.3)).normalized();
  Vec3 bias = Vec3(Scalar(0.05), Scalar(-0.08), Scalar(0.03));
  Vec3 m_C = Vec3(Scalar(0.05), Scalar(-0.02), Scalar(0.03));
  Mat3 R_CB = exp_so3(Vec3(0, 0, Scalar(1.5))).toRotationMatrix();
};

constexpr MovingStartNoise kNoise = {Scalar(kGravity), Scalar(1e-4), Scalar(2e-3),
                                     Scalar(5e-5),     Scalar(3e-4), Scalar(0.2)};

void test_exact_samples_should_give_the_exact_scale_gravity_and_bias() {
  SeededRandom random(331);
  const Clip clip;
  const std::vector<MovingPose> poses = clip.poses(28, 0.1, 0, random);
  MovingSolution found;
  TEST_ASSERT_TRUE(solve_moving_start(poses.data(), 28, kNoise, &found));
  TEST_ASSERT_TRUE(std::abs(found.scale / clip.scale - 1) < Scalar(1e-3));
  TEST_ASSERT_TRUE((found.q_WG.toRotationMatrix().col(2) - clip.down).norm() < Scalar(1e-3));
  TEST_ASSERT_TRUE((found.accel_bias - clip.bias).norm() < Scalar(5e-3));
  TEST_ASSERT_TRUE(found.misfit < Scalar(0.1));
  TEST_ASSERT_TRUE(found.sigma_scale() < Scalar(0.02));
}

/// What the accelerometer's scale and axes are off is in scale, gravity and bias, as by_force says.
void test_intrinsics_that_are_off_should_put_the_solution_off_by_as_much_as_it_says() {
  SeededRandom random(332);
  for (int trial = 0; trial < 5; ++trial) {
    const Clip exact;
    Clip clip;
    Eigen::Matrix<Scalar, 9, 1> e;
    for (int i = 0; i < 9; ++i) e(i) = Scalar(0.01 * random.normal());
    Mat3 E;
    E << e(0), e(1), e(2), e(3), e(4), e(5), e(6), e(7), e(8);
    clip.by_force = (Mat3::Identity() + E).inverse();
    const MovingStartNoise::OfForce of_force = Scalar(1e-4) * MovingStartNoise::OfForce::Identity();
    MovingStartNoise noise = kNoise;
    noise.of_force = &of_force;
    const std::vector<MovingPose> poses = clip.poses(28, 0.1, 0, random), at = exact.poses(28, 0.1, 0, random);
    MovingSolution found, right;
    TEST_ASSERT_TRUE(solve_moving_start(poses.data(), 28, noise, &found));
    TEST_ASSERT_TRUE(solve_moving_start(at.data(), 28, noise, &right));
    Eigen::Matrix<Scalar, 6, 1> off;  // what is missing
    const Mat3 R_WG = found.q_WG.toRotationMatrix();
    const Vec3 tilt = R_WG.col(2).cross(right.q_WG.toRotationMatrix().col(2));
    off << std::log(right.scale / found.scale), tilt.dot(R_WG.col(0)), tilt.dot(R_WG.col(1)),
        right.accel_bias - found.accel_bias;
    const Eigen::Matrix<Scalar, 6, 1> expected = found.by_force * e;
    for (int i = 0; i < 6; ++i) {
      if (std::abs(off(i) - expected(i)) > Scalar(0.15) * expected.norm() + Scalar(1e-3))
        std::printf("row %d: %.5f, %.5f expected\n", i, static_cast<double>(off(i)), static_cast<double>(expected(i)));
      TEST_ASSERT_TRUE(std::abs(off(i) - expected(i)) <= Scalar(0.15) * expected.norm() + Scalar(1e-3));
    }
    TEST_ASSERT_TRUE(found.sigma_scale() > Scalar(0.005));
    noise.of_force = nullptr;
    TEST_ASSERT_TRUE(solve_moving_start(poses.data(), 28, noise, &right));
    TEST_ASSERT_TRUE((found.covariance - right.covariance - found.of_force).norm() < Scalar(1e-5));
  }
}

struct Honesty {
  double nees = 0;         ///< of scale, gravity and bias together, six degrees of freedom, mean over 40 draws
  double worst = 0;        ///< error of the scale in its own sigma
  double sigma_scale = 0;  ///< mean
};

/// turn: sigma of the rate at which the poses' rotations turn away from the truth. uses_rest: the clip begins at rest, which is told.
Honesty honesty_of(int count, double interval, double turn, MovingStartNoise noise, std::uint64_t seed,
                   bool from_rest = false, bool uses_rest = false) {
  SeededRandom random(seed);
  constexpr int kDraws = 40;
  Honesty out;
  for (int k = 0; k < kDraws; ++k) {
    Clip clip;
    clip.bias = random.normals<3>(0.2);
    clip.turn = random.normals<3>(turn);
    clip.from_rest = from_rest;
    const std::vector<MovingPose> poses = clip.poses(count, interval, kSigma, random);
    const MovingRest rest = clip.rest((count - 1) * interval, random);
    noise.rest = uses_rest ? &rest : nullptr;
    MovingSolution found;
    TEST_ASSERT_TRUE(solve_moving_start(poses.data(), count, noise, &found));
    Eigen::Matrix<double, 6, 1> e;
    e(0) = std::log(static_cast<double>(clip.scale / found.scale));
    const Mat3 R_WG = found.q_WG.toRotationMatrix();
    const Vec3 tilt = R_WG.col(2).cross(clip.down);
    e(1) = static_cast<double>(tilt.dot(R_WG.col(0)));
    e(2) = static_cast<double>(tilt.dot(R_WG.col(1)));
    for (int i = 0; i < 3; ++i) e(3 + i) = static_cast<double>(clip.bias(i) - found.accel_bias(i));
    const Eigen::Matrix<double, 6, 6> C = found.covariance.cast<double>();
    out.nees += e.dot(C.inverse() * e) / kDraws;
    out.worst = std::max(out.worst, std::fabs(e(0)) / static_cast<double>(found.sigma_scale()));
    out.sigma_scale += static_cast<double>(found.sigma_scale()) / kDraws;
  }
  return out;
}

/// 95 % of the mean of 40 lies within 4.9 and 7.2; the samples are exact here, which the solution does not know.
void expect_honest(const Honesty& of) {
  if (!(of.nees > 2 && of.nees < 7.2)) std::printf("NEES %.2f of 6\n", of.nees);
  TEST_ASSERT_TRUE(of.nees > 2 && of.nees < 7.2);
  TEST_ASSERT_TRUE(of.worst < 4);
}

void test_noise_of_poses_should_be_that_of_the_solution() {
  const Honesty few = honesty_of(28, 0.1, 3e-4, kNoise, 332);
  const Honesty many = honesty_of(84, 1 / 30.0, 3e-4, kNoise, 335);  // rows are means over three
  expect_honest(few);
  expect_honest(many);
  if (!(many.sigma_scale < 0.85 * few.sigma_scale))
    std::printf("sigma of scale %.4f of 28 poses, %.4f of 84\n", few.sigma_scale, many.sigma_scale);
  TEST_ASSERT_TRUE(many.sigma_scale < 0.85 * few.sigma_scale);
}

void test_poses_that_turn_away_should_be_allowed_for() {
  MovingStartNoise noise = kNoise;
  noise.turn = Scalar(1.5e-3);
  expect_honest(honesty_of(84, 1 / 30.0, 1.5e-3, noise, 336));
  noise.turn = 0;
  const Honesty blind = honesty_of(84, 1 / 30.0, 1.5e-3, noise, 336);
  if (!(blind.nees > 12)) std::printf("NEES %.2f without\n", blind.nees);
  TEST_ASSERT_TRUE(blind.nees > 12);
}

/// A rest before the first pose halves the sigma of the scale in the first second and a half, and stays honest, also where rotations drift.
void test_a_rest_should_tell_the_scale_sooner() {
  const Honesty without = honesty_of(46, 1 / 30.0, 3e-4, kNoise, 338, true, false);
  const Honesty with = honesty_of(46, 1 / 30.0, 3e-4, kNoise, 338, true, true);
  expect_honest(with);
  if (!(with.sigma_scale < 0.5 * without.sigma_scale))
    std::printf("sigma of scale %.4f with a rest, %.4f without\n", with.sigma_scale, without.sigma_scale);
  TEST_ASSERT_TRUE(with.sigma_scale < 0.5 * without.sigma_scale);
  MovingStartNoise noise = kNoise;
  noise.turn = Scalar(1.5e-3);
  expect_honest(honesty_of(84, 1 / 30.0, 1.5e-3, noise, 339, true, true));
}

/// What the solution is off by: truth less estimate, as by_turn has it.
Eigen::Matrix<double, 6, 1> error_of(const Clip& clip, const MovingSolution& found) {
  Eigen::Matrix<double, 6, 1> e;
  e(0) = std::log(static_cast<double>(clip.scale / found.scale));
  const Mat3 R_WG = found.q_WG.toRotationMatrix();
  const Vec3 turn = R_WG.col(2).cross(clip.down);
  e(1) = static_cast<double>(turn.dot(R_WG.col(0)));
  e(2) = static_cast<double>(turn.dot(R_WG.col(1)));
  e.tail<3>() = (clip.bias - found.accel_bias).cast<double>();
  return e;
}

void test_solution_should_know_what_poses_that_turn_away_put_it_off_by() {
  MovingStartNoise noise = kNoise;
  noise.turn = Scalar(1.5e-3);
  MovingSolution found, straight;
  Clip clip;
  clip.reach = 0.1;  // gravity is most of what the unit feels, and all that by_turn has
  SeededRandom random(337);
  TEST_ASSERT_TRUE(solve_moving_start(clip.poses(84, 1 / 30.0, 0, random).data(), 84, noise, &straight));
  const Eigen::Matrix<double, 6, 1> before = error_of(clip, straight);
  for (int axis = 0; axis < 3; ++axis) {
    clip.turn = Vec3::Zero();
    clip.turn(axis) = Scalar(1.5e-3);
    TEST_ASSERT_TRUE(solve_moving_start(clip.poses(84, 1 / 30.0, 0, random).data(), 84, noise, &found));
    // The poses are Exp(turn t) of the truth, so the truth is Exp(-turn t) of the poses.
    const Eigen::Matrix<double, 6, 1> e = error_of(clip, found) - before;
    const Eigen::Matrix<double, 6, 1> told = -1.5e-3 * straight.by_turn.col(axis).cast<double>();
    TEST_ASSERT_TRUE((e - told).norm() < 0.15 * e.norm() + 6e-4);
  }
  // Its share of the covariance is within that.
  const Eigen::Matrix<double, 6, 6> rest =
      (found.covariance - found.turn_variance * found.by_turn * found.by_turn.transpose()).cast<double>();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> eigen(rest, Eigen::EigenvaluesOnly);
  TEST_ASSERT_TRUE(eigen.eigenvalues()(0) > -1e-9);
}

void test_a_camera_at_constant_velocity_should_know_that_it_tells_nothing() {
  SeededRandom random(333);
  Clip clip;
  clip.even = true;
  const std::vector<MovingPose> poses = clip.poses(28, 0.1, kSigma, random);
  MovingSolution found;
  TEST_ASSERT_TRUE(!solve_moving_start(poses.data(), 28, kNoise, &found) || found.sigma_scale() > Scalar(0.1));
}

void test_too_few_poses_should_be_refused() {
  SeededRandom random(334);
  const std::vector<MovingPose> poses = Clip().poses(kMaxMovingPoses + 1, 0.1, 0, random);
  MovingSolution found;
  TEST_ASSERT_FALSE(solve_moving_start(poses.data(), 3, kNoise, &found));
  TEST_ASSERT_FALSE(solve_moving_start(poses.data(), kMaxMovingPoses + 1, kNoise, &found));
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_exact_samples_should_give_the_exact_scale_gravity_and_bias);
  RUN_TEST(test_intrinsics_that_are_off_should_put_the_solution_off_by_as_much_as_it_says);
  RUN_TEST(test_noise_of_poses_should_be_that_of_the_solution);
  RUN_TEST(test_poses_that_turn_away_should_be_allowed_for);
  RUN_TEST(test_a_rest_should_tell_the_scale_sooner);
  RUN_TEST(test_solution_should_know_what_poses_that_turn_away_put_it_off_by);
  RUN_TEST(test_a_camera_at_constant_velocity_should_know_that_it_tells_nothing);
  RUN_TEST(test_too_few_poses_should_be_refused);
  return UNITY_END();
}
