// Pixels of a place's points, and the drift of the window as an error of a similarity.
#include "geometry/pnp.h"
#include "geometry/similarity_error.h"
#include "keyframe_slam/loops/place_measurement.h"
#include "support/numeric_jacobian.h"
#include "support/seeded_random.h"
#include "support/test_cameras.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

using Vec7 = Eigen::Matrix<Scalar, 7, 1>;
using Mat7 = Eigen::Matrix<Scalar, 7, 7>;

void test_pixel_by_a_point_in_its_place_should_be_exact() {
  SeededRandom random(41);
  for (int trial = 0; trial < 40; ++trial) {
    const Camera camera = test_camera_of(trial % kTestCameras);
    const Quat q_WC = exp_so3(random.normals<3>(0.5)), q_WK = exp_so3(random.normals<3>(0.5));
    const Vec3 p_WC = random.normals<3>(1), p_WK = random.normals<3>(1);
    const Vec3 in_C(static_cast<Scalar>(random.uniform(-0.3, 0.3)), static_cast<Scalar>(random.uniform(-0.3, 0.3)), 1);
    const Vec3 x_K = q_WK.conjugate() * (p_WC + q_WC * Vec3(2 * in_C) - p_WK);
    Vec2 z;
    Mat26 J_pose;
    const auto pixel = [&](const Vec3& d) {
      Vec2 moved;
      TEST_ASSERT_TRUE(
          project_from_pose(camera, q_WC, p_WC, p_WK + q_WK * Vec3(x_K + d), Scalar(1), p_WC, &moved, &J_pose));
      return moved;
    };
    pixel(Vec3::Zero());
    check_jacobian<2, 3>(pixel_by_place_point(q_WK, J_pose), pixel, "J_pixel_point");
  }
}

/// The error of a similarity about a place, from how it moves things.
Vec7 error_about(const Similarity& T, const Vec3& place) {
  Vec7 out;
  out << log_so3(T.q), T.of(place) - place, std::log(T.s);
  return out;
}

void test_error_about_another_place_should_be_exact() {
  SeededRandom random(42);
  for (int trial = 0; trial < 20; ++trial) {
    const Vec3 a = random.normals<3>(1), b = random.normals<3>(1);
    check_jacobian<7, 7>(
        Mat7(similarity_error_at(b - a).cast<Scalar>()),
        [&](const Vec7& e) { return error_about(similarity_of(e.cast<double>(), a), b); }, "J_error_error", 1,
        10 * kNumericJacobianTolerance);
  }
}

/// Of a camera the drift about it is its own: H = [I 0].
void test_pose_by_the_drift_about_the_camera_should_be_exact() {
  const Vec3 c(1, -2, Scalar(0.5));
  Eigen::Matrix<Scalar, 6, 7> H = Eigen::Matrix<Scalar, 6, 7>::Zero();
  H.leftCols<6>().setIdentity();
  check_jacobian<6, 7>(
      H, [&](const Vec7& e) { return Vec6(error_about(similarity_of(e.cast<double>(), c), c).head<6>()); },
      "J_pose_drift");
}

void test_covariance_in_a_world_that_is_moved_should_be_exact() {
  SeededRandom random(43);
  const Similarity T = {exp_so3(random.normals<3>(0.5)), random.normals<3>(1), Scalar(1.6)};
  const auto moved = [&](const Vec7& e) {
    const Similarity S = similarity_of(e.cast<double>(), Vec3::Zero());
    const Vec3 origin_before = T.q.conjugate() * Vec3(-T.t / T.s);
    Vec7 out;
    out << log_so3(Quat(T.q * S.q * T.q.conjugate())), T.of(S.of(origin_before)), std::log(S.s);
    return out;
  };
  const Eigen::Matrix<double, 7, 7> J = numeric_jacobian<7, 7>(moved, kNumericJacobianStep).cast<double>();
  SimilarityCovariance A;
  for (int i = 0; i < 7; ++i)
    for (int j = 0; j < 7; ++j) A(i, j) = random.normal();
  const SimilarityCovariance C = A * A.transpose(), expected = J * C * J.transpose();
  TEST_ASSERT_TRUE((moved_covariance(T, C) - expected).norm() <
                   100 * static_cast<double>(kNumericJacobianTolerance) * expected.norm());
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_pixel_by_a_point_in_its_place_should_be_exact);
  RUN_TEST(test_error_about_another_place_should_be_exact);
  RUN_TEST(test_pose_by_the_drift_about_the_camera_should_be_exact);
  RUN_TEST(test_covariance_in_a_world_that_is_moved_should_be_exact);
  return UNITY_END();
}
