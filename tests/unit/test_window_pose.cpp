// The window's fit of a pose to matches and prediction, and its motion.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "bundle/bundle_adjuster.h"
#include "geometry/so3.h"
#include "keyframe_slam/tracking/motion.h"
#include "keyframe_slam/tracking/pose.h"
#include "support/dense.h"
#include "support/seeded_random.h"
#include "support/test_cameras.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr bool kFloat = sizeof(Scalar) == 4;
constexpr int kMatches = 30;
constexpr Scalar kHuber = 2;

struct Matches {
  CameraPose truth;
  PoseMatch match[kMatches];
  unsigned char use[kMatches];
  PosePrior prior;
};

/// Points in view of a camera, with pixels off by sigma times what their noise says, and a prediction that is off as well.
Matches random_matches(const Camera& camera, SeededRandom& random, double sigma) {
  Matches all;
  all.truth = {exp_so3(random.normals<3>(0.5)), random.normals<3>(1.0)};
  for (int i = 0; i < kMatches; ++i) {
    const Vec3 in_C =
        Vec3(static_cast<Scalar>(random.uniform(-0.5, 0.5)), static_cast<Scalar>(random.uniform(-0.4, 0.4)), 1) *
        static_cast<Scalar>(random.uniform(1, 4));
    const Vec3 p_W = all.truth.p_WC + all.truth.q_WC * in_C;
    const Scalar w = static_cast<Scalar>(random.uniform(0.2, 1));
    PoseMatch& match = all.match[i];
    match.point = {w * p_W, w, Vec2::Zero()};
    match.noise << Scalar(0.5), Scalar(0.1), Scalar(0.1), Scalar(0.8);
    TEST_ASSERT_TRUE(project(camera, in_C, &match.point.pixel));
    match.point.pixel += random.normals<2>(sigma);
    all.use[i] = 1;
  }
  all.prior = {exp_so3(random.normals<3>(0.02)) * all.truth.q_WC, all.truth.p_WC + random.normals<3>(0.03),
               Mat6::Identity()};
  return all;
}

/// The cost that fit_pose minimises, with the pose rotated and moved by x.
double cost_at(const Camera& camera, const Matches& all, const CameraPose& pose, const Vec6& x) {
  const CameraPose at = {exp_so3(Vec3(x.head<3>())) * pose.q_WC, pose.p_WC + x.tail<3>()};
  double cost = 0;
  for (int i = 0; i < kMatches; ++i) {
    Vec2 z;
    const PnpPoint& point = all.match[i].point;
    if (!project_from_pose(camera, at.q_WC, at.p_WC, point.m, point.w, at.p_WC, &z)) continue;
    const Vec2 r = point.pixel - z;
    Scalar weight;
    cost += static_cast<double>(huber_cost(r.dot(all.match[i].noise.inverse() * r), kHuber, &weight));
  }
  Vec6 e;
  e << log_so3(all.prior.q_WC * at.q_WC.conjugate()), all.prior.p_W - at.p_WC;
  return cost + static_cast<double>(e.dot(all.prior.covariance.inverse() * e));
}

void test_fit_pose_should_find_the_pose_that_made_the_pixels() {
  SeededRandom random(1);
  const Camera camera = pinhole_camera();
  for (int run = 0; run < 20; ++run) {
    Matches all = random_matches(camera, random, 0);
    all.prior.covariance *= 100;
    CameraPose pose = {all.prior.q_WC, all.prior.p_W};
    Mat6 information;
    TEST_ASSERT_TRUE(fit_pose(camera, all.match, kMatches, all.use, all.prior, kHuber, &pose, &information));
    TEST_ASSERT_TRUE(pose.q_WC.angularDistance(all.truth.q_WC) < 1e-3);
    TEST_ASSERT_TRUE((pose.p_WC - all.truth.p_WC).norm() < 1e-3);
  }
}

void test_fit_pose_should_end_where_the_cost_has_no_slope() {
  if (kFloat) return;  // differences of a cost say nothing there
  SeededRandom random(2);
  const Camera camera = pinhole_camera();
  for (int run = 0; run < 20; ++run) {
    Matches all = random_matches(camera, random, 0.4);
    all.prior.covariance *= static_cast<Scalar>(1e-4);
    CameraPose pose = {all.prior.q_WC, all.prior.p_W};
    Mat6 information;
    TEST_ASSERT_TRUE(fit_pose(camera, all.match, kMatches, all.use, all.prior, kHuber, &pose, &information));
    const double at_end = cost_at(camera, all, pose, Vec6::Zero());
    for (int i = 0; i < 6; ++i) {
      // A step of a tenth of a standard deviation to either side costs more.
      const Scalar step = Scalar(0.1) / std::sqrt(information(i, i) + 1 / all.prior.covariance(i, i));
      TEST_ASSERT_TRUE(cost_at(camera, all, pose, Vec6(step * Vec6::Unit(i))) > at_end);
      TEST_ASSERT_TRUE(cost_at(camera, all, pose, Vec6(-step * Vec6::Unit(i))) > at_end);
    }
  }
}

void test_fit_pose_should_stay_at_the_prediction_without_matches() {
  SeededRandom random(3);
  const Camera camera = pinhole_camera();
  Matches all = random_matches(camera, random, 0);
  std::fill(all.use, all.use + kMatches, static_cast<unsigned char>(0));
  CameraPose pose = all.truth;
  Mat6 information;
  TEST_ASSERT_TRUE(fit_pose(camera, all.match, kMatches, all.use, all.prior, kHuber, &pose, &information));
  TEST_ASSERT_TRUE(pose.q_WC.angularDistance(all.prior.q_WC) < 1e-3);
  TEST_ASSERT_TRUE((pose.p_WC - all.prior.p_W).norm() < 1e-3);
  TEST_ASSERT_TRUE(information.isZero(0));
}

/// With a large Huber bound, so that no match is cut off: ln N(r; 0, J P Jᵀ + R) by a dense factor.
void test_log_density_should_be_that_of_the_joint_covariance() {
  if (kFloat) return;  // differences of densities of 60 numbers
  SeededRandom random(4);
  const Camera camera = pinhole_camera();
  for (int run = 0; run < 20; ++run) {
    Matches all = random_matches(camera, random, 0.02);
    all.prior.q_WC = all.truth.q_WC * exp_so3(random.normals<3>(1e-4));
    all.prior.p_W = all.truth.p_WC + random.normals<3>(1e-4);
    all.prior.covariance *= static_cast<Scalar>(1e-6);
    all.use[run] = 0;
    Dense S = Dense::Zero(2 * kMatches - 2, 2 * kMatches - 2), J(2 * kMatches - 2, 6);
    Eigen::VectorXd r(2 * kMatches - 2);
    for (int i = 0, row = 0; i < kMatches; ++i) {
      if (all.use[i] == 0) continue;
      const PnpPoint& point = all.match[i].point;
      Vec2 z;
      Mat26 J_i;
      TEST_ASSERT_TRUE(
          project_from_pose(camera, all.prior.q_WC, all.prior.p_W, point.m, point.w, all.prior.p_W, &z, &J_i));
      J.middleRows(row, 2) = J_i.cast<double>();
      S.block(row, row, 2, 2) = all.match[i].noise.cast<double>();
      r.segment<2>(row) = (point.pixel - z).cast<double>();
      row += 2;
    }
    S += J * all.prior.covariance.cast<double>() * J.transpose();
    const Dense L = lower_factor(S);
    const double expected = -r.dot(solved(S, r).col(0)) / 2 - L.diagonal().array().log().sum() -
                            static_cast<double>(kMatches - 1) * std::log(6.283185307179586);
    CameraPose pose = {all.prior.q_WC, all.prior.p_W};
    Mat6 information;
    TEST_ASSERT_TRUE(fit_pose(camera, all.match, kMatches, all.use, all.prior, 1000, &pose, &information));
    TEST_ASSERT_DOUBLE_WITHIN(
        1e-3, expected,
        static_cast<double>(log_density(camera, all.match, kMatches, all.use, all.prior, pose, information)));
  }
}

void test_motion_should_learn_velocities_from_poses() {
  Settings settings;
  settings.constant_velocity = true;
  settings.body = BodyLayout::with_constant_velocity();
  settings.motion_noise = {Scalar(0.01), Scalar(0.01)};
  KeyframeMotion motion(settings);
  motion.init();
  const Mat6 R = Mat6::Identity() * Scalar(1e-6);
  motion.set(Body(), R, 1, 1);
  const Vec3 v(Scalar(0.5), Scalar(-0.2), Scalar(0.1)), w(Scalar(0.1), Scalar(0.3), Scalar(-0.2));
  constexpr std::int64_t kStepNs = 50000000;
  for (int k = 1; k <= 10; ++k) {
    const Scalar t = static_cast<Scalar>(k) * Scalar(0.05);
    motion.advance((k - 1) * kStepNs, k * kStepNs, false, false);
    TEST_ASSERT_TRUE(motion.correct(exp_so3(Vec3(w * t)), v * t, R.cast<double>()));
    TEST_ASSERT_TRUE(motion.is_sound());
  }
  TEST_ASSERT_TRUE((motion.body().v_W - v).norm() < 0.01);
  TEST_ASSERT_TRUE((motion.body().w_C - w).norm() < 0.01);
  // The measured pose and the prediction together are better than either.
  TEST_ASSERT_TRUE(motion.pose_covariance().trace() < R.trace());
  Body later;
  Mat6 covariance;
  motion.predict_pose(10 * kStepNs, 12 * kStepNs, &later, &covariance);
  TEST_ASSERT_TRUE((later.p_W - v * Scalar(0.6)).norm() < 0.005);
  TEST_ASSERT_TRUE(covariance.trace() > motion.pose_covariance().trace());
}

/// Largest difference as correlations.
double difference(const KeyframeMotion::Covariance& P, const Eigen::MatrixXd& expected) {
  double largest = 0;
  for (int i = 0; i < KeyframeMotion::kMaxRows; ++i)
    for (int j = 0; j < KeyframeMotion::kMaxRows; ++j)
      largest = std::max(largest, std::abs(static_cast<double>(P(i, j)) - expected(i, j)) /
                                      std::sqrt(expected(i, i) * expected(j, j)));
  return largest;
}

void test_motion_should_keep_a_covariance_where_the_pose_was_hardly_known() {
  Settings settings;
  settings.constant_velocity = true;
  settings.body = BodyLayout::with_constant_velocity();
  settings.motion_noise = {Scalar(1), Scalar(1)};
  SeededRandom random(7);
  for (int k = 0; k < 50; ++k) {
    KeyframeMotion motion(settings);
    motion.init();
    Body body;
    body.v_W = random.normals<3>(300.0);
    body.w_C = random.normals<3>(300.0);
    motion.set(body, Mat6(Mat6::Identity() * Scalar(50)), 1, 1);
    for (int step = 1; step < 5; ++step) motion.advance((step - 1) * 40000000, step * 40000000, false, false);
    Mat6 half, R;
    for (int i = 0; i < 36; ++i) half(i / 6, i % 6) = static_cast<Scalar>(random.normal() * 0.003);
    R = half * half.transpose() + Mat6(Mat6::Identity() * Scalar(1e-6));
    const Eigen::MatrixXd P = motion.covariance().cast<double>();
    const Eigen::MatrixXd gain = solved(P.topLeftCorner(6, 6) + R.cast<double>(), P.topRows(6)).transpose();
    const Eigen::MatrixXd kept = Eigen::MatrixXd::Identity(12, 12) - gain * Eigen::MatrixXd::Identity(6, 12);
    const Eigen::MatrixXd expected = kept * P * kept.transpose() + gain * R.cast<double>() * gain.transpose();
    TEST_ASSERT_TRUE(motion.correct(Quat::Identity(), Vec3::Zero(), R.cast<double>()));
    TEST_ASSERT_TRUE(difference(motion.covariance(), expected) < (kFloat ? 1e-3 : 1e-9));
  }
}

double smallest_correlation(const Eigen::MatrixXd& P) {
  const Eigen::VectorXd scale = P.diagonal().cwiseSqrt().cwiseInverse();
  return eigenvalues_of(scale.asDiagonal() * P * scale.asDiagonal())(0);
}

/// Matches that leave one direction open, however they lie to the axes: their covariance is 1e8 times as large there.
void test_motion_should_keep_a_covariance_where_matches_leave_a_direction_open() {
  SeededRandom random(9);
  double smallest = 1, largest_gain = 0;
  for (int k = 0; k < 200; ++k) {
    Settings settings;
    settings.body = BodyLayout::with_constant_position();
    KeyframeMotion motion(settings);
    motion.init();
    Eigen::Matrix<double, 6, 6> half, spread = Eigen::Matrix<double, 6, 6>::Identity() * 1e-6;
    for (int i = 0; i < 36; ++i) half(i / 6, i % 6) = random.normal() * 0.1;
    spread += half * half.transpose();
    motion.set(Body(), spread.cast<Scalar>(), 0, 0);
    const Eigen::Matrix<double, 6, 1> open = random.normals<6>(1.0).cast<double>().normalized();
    const KeyframeMotion::Wide6 R = KeyframeMotion::Wide6::Identity() * 1e-6 + 100 * open * open.transpose();
    const double before = static_cast<double>(motion.pose_covariance().trace());
    TEST_ASSERT_TRUE(motion.correct(Quat::Identity(), Vec3::Zero(), R));
    smallest = std::min(smallest, smallest_correlation(motion.pose_covariance().cast<double>()));
    largest_gain = std::max(largest_gain, static_cast<double>(motion.pose_covariance().trace()) / before);
  }
  std::printf("smallest eigenvalue %.3g; at most %.3g of the variance is left\n", smallest, largest_gain);
  TEST_ASSERT_TRUE(smallest > -1e-6);
  TEST_ASSERT_TRUE(largest_gain < 1);
}

/// A speed along one line that decays leaves variances along that line beside which float rounds what is known across it.
void test_motion_should_keep_a_covariance_while_an_absurd_speed_decays() {
  SeededRandom random(8);
  double smallest = 1, smallest_corrected = 1;
  int refused = 0;
  for (int k = 0; k < 200; ++k) {
    Settings settings;
    settings.constant_velocity = true;
    settings.body = BodyLayout::with_constant_velocity();
    settings.motion_noise = {static_cast<Scalar>(std::pow(10, random.uniform(-2, 1))),
                             static_cast<Scalar>(std::pow(10, random.uniform(-2, 1)))};
    KeyframeMotion motion(settings);
    motion.init();
    Body body;
    body.v_W = random.normals<3>(std::pow(10, random.uniform(0, 4)));
    body.w_C = random.normals<3>(std::pow(10, random.uniform(0, 5)));
    motion.set(body, Mat6(Mat6::Identity() * Scalar(1e-4)), 5, Scalar(0.05));
    std::int64_t t_ns = 0;
    for (int step = 0; step < 20; ++step) {
      const std::int64_t before_ns = t_ns;
      t_ns += step == 10 ? 2000000000 : 33333333;
      motion.advance(before_ns, t_ns, true, true);
      smallest = std::min(smallest, smallest_correlation(motion.covariance().cast<double>()));
    }
    const Mat6 R = Mat6::Identity() * static_cast<Scalar>(std::pow(10, random.uniform(-6, -2)));
    refused += motion.correct(body.q_WC, body.p_W, R.cast<double>()) ? 0 : 1;
    smallest_corrected = std::min(smallest_corrected, smallest_correlation(motion.pose_covariance().cast<double>()));
  }
  std::printf("smallest eigenvalue %.3g, of corrected poses %.3g; %d corrections refused\n", smallest,
              smallest_corrected, refused);
  TEST_ASSERT_EQUAL_INT(0, refused);
  TEST_ASSERT_TRUE(smallest > -1e-12);
  TEST_ASSERT_TRUE(smallest_corrected > 0);
}

/// v_W += R dv_C, w_C += dw_C in the next prediction alone.
void test_motion_should_follow_a_control_once() {
  Settings settings;
  settings.body = BodyLayout::with_constant_velocity();
  settings.motion_noise = {Scalar(1), Scalar(1)};
  KeyframeMotion motion(settings), without(settings);
  Body body;
  body.q_WC = exp_so3(Vec3(0, 0, Scalar(0.5)));
  body.v_W = Vec3(1, 0, 0);
  for (KeyframeMotion* one : {&motion, &without})
    one->set(body, Mat6(Mat6::Identity() * Scalar(1e-4)), Scalar(0.1), Scalar(0.1));
  const Vec3 dv_C(0, Scalar(0.4), 0), dw_C(0, 0, Scalar(0.3));
  motion.push_control(dv_C / 2, dw_C / 2);
  motion.push_control(dv_C / 2, dw_C / 2);
  for (int frame = 0; frame < 2; ++frame)
    for (KeyframeMotion* one : {&motion, &without})
      one->advance(frame * 100000000, (frame + 1) * 100000000, false, false);
  const Vec3 dv_W = body.q_WC * dv_C;
  TEST_ASSERT_TRUE((motion.body().v_W - without.body().v_W - dv_W).norm() < Scalar(1e-5));
  TEST_ASSERT_TRUE((motion.body().w_C - without.body().w_C - dw_C).norm() < Scalar(1e-5));
  TEST_ASSERT_TRUE((motion.body().p_W - without.body().p_W - Scalar(0.2) * dv_W).norm() < Scalar(1e-5));
  TEST_ASSERT_TRUE(motion.is_sound());
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_fit_pose_should_find_the_pose_that_made_the_pixels);
  RUN_TEST(test_fit_pose_should_end_where_the_cost_has_no_slope);
  RUN_TEST(test_fit_pose_should_stay_at_the_prediction_without_matches);
  RUN_TEST(test_log_density_should_be_that_of_the_joint_covariance);
  RUN_TEST(test_motion_should_learn_velocities_from_poses);
  RUN_TEST(test_motion_should_follow_a_control_once);
  RUN_TEST(test_motion_should_keep_a_covariance_where_the_pose_was_hardly_known);
  RUN_TEST(test_motion_should_keep_a_covariance_where_matches_leave_a_direction_open);
  RUN_TEST(test_motion_should_keep_a_covariance_while_an_absurd_speed_decays);
  return UNITY_END();
}
