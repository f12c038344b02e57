// Pixels of a camera whose rows are read out one after the other: where they lie, and their Jacobians.
#include "support/filter_cases.h"
#include "support/numeric_jacobian.h"
#include "support/test_cameras.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

using Vec12 = Eigen::Matrix<Scalar, 12, 1>;

Body moved_with_speeds(Body body, const Vec12& e) {
  body = moved(body, Vec6(e.head<6>()));
  body.v_W += e.segment<3>(6);
  body.w_C += e.tail<3>();
  return body;
}

Camera rolling_camera(int trial) {
  Camera camera = test_camera_of(trial % kTestCameras);
  camera.readout = Scalar(0.03);
  return camera;
}

PixelMeasurement seen(TestFilter& filter, const Camera& camera, const Body& body, int slot) {
  filter->set_mean(body);
  PixelMeasurement o;
  TEST_ASSERT_TRUE(filter->predict_pixel(camera, slot, &o));
  return o;
}

/// The pixel is where the camera of its own row's time sees the point.
void test_pixel_should_be_what_its_own_row_sees() {
  SeededRandom random(141);
  for (int trial = 0; trial < 40; ++trial) {
    const Camera camera = rolling_camera(trial);
    TestFilter filter(true);
    const Body body = random_body(random);
    const Vec3 p_W = point_in_view(random, body);
    const Vec2 z = seen(filter, camera, body, filter->add_point(p_W, Mat3::Identity())).predicted;
    const Scalar tau = camera.readout * ((z.y() + Scalar(0.5)) / static_cast<Scalar>(camera.height) - Scalar(0.5));
    Vec2 expected;
    TEST_ASSERT_TRUE(project(
        camera, (body.q_WC * exp_so3(body.w_C * tau)).conjugate() * (p_W - body.p_W - body.v_W * tau), &expected));
    TEST_ASSERT_TRUE((z - expected).norm() < Scalar(0.02));
  }
}

void test_jacobians_should_be_exact_by_pose_speeds_and_point() {
  SeededRandom random(142);
  for (int trial = 0; trial < 40; ++trial) {
    const Camera camera = rolling_camera(trial);
    TestFilter filter(true);
    const Body body = random_body(random);
    const Vec3 p_W = point_in_view(random, body);
    const int slot = filter->add_point(p_W, Mat3::Identity());
    const Dense H = dense_rows(*filter, seen(filter, camera, body, slot).H);
    const Eigen::Matrix<Scalar, 2, 12> J_body = H.leftCols<12>().cast<Scalar>();
    const Mat23 J_point = H.rightCols<3>().cast<Scalar>();
    // The row is found in two turns, which leaves its square: a few thousandths.
    check_jacobian<2, 12>(
        J_body, [&](const Vec12& e) { return seen(filter, camera, moved_with_speeds(body, e), slot).predicted; },
        "J_z_body", Scalar(0.5), Scalar(4e-3));
    check_jacobian<2, 3>(
        J_point,
        [&](const Vec3& e) {
          TestFilter other(true);
          return seen(other, camera, body, other->add_point(p_W + e, Mat3::Identity())).predicted;
        },
        "J_z_point", Scalar(0.5), Scalar(4e-3));
  }
}

void test_speeds_should_not_matter_to_a_camera_that_reads_out_at_once() {
  SeededRandom random(143);
  Camera camera = rolling_camera(0);
  camera.readout = Scalar(0);
  TestFilter filter(true);
  const Body body = random_body(random);
  const int slot = filter->add_point(point_in_view(random, body), Mat3::Identity());
  const PixelMeasurement o = seen(filter, camera, body, slot);
  TEST_ASSERT_EQUAL_INT(9, o.H.columns());
}

/// The camera was off by c = v tau when the row of a new point was read out, which turns its bearing by rho c. With independent errors of
/// rho and v about a speed of zero, (rho^2 + sigma^2) cov c.
void test_a_new_point_of_a_late_row_should_not_know_its_bearing_better_than_depth_and_speed_together() {
  SeededRandom random(144);
  constexpr Scalar kRho = Scalar(0.5), kSigma = Scalar(0.4), kTau = Scalar(0.012);
  for (int trial = 0; trial < 10; ++trial) {
    Dense bearing[2];
    Body body = random_body(random);
    body.v_W.setZero();
    const Dense cov_v = random_covariance(random, 3, 1);
    for (const bool open_depth : {false, true}) {
      TestFilter filter(true);
      filter->set_mean(body);
      const int anchor = filter->add_anchor();
      Dense P = Dense::Zero(filter.dim(), filter.dim());
      P.block(6, 6, 3, 3) = cov_v;
      filter.set_P(P);
      const Vec3 ray = Vec3(Scalar(0.1), Scalar(-0.2), 1).normalized();
      const int slot = filter->add_inverse_depth(anchor, ray, Mat32::Zero(), Mat2::Zero(), kRho,
                                                 open_depth ? kSigma : Scalar(0), kTau);
      bearing[open_depth] = filter.P().block(filter.first(slot), filter.first(slot), 2, 2);
    }
    const double expected = static_cast<double>(1 + kSigma * kSigma / (kRho * kRho));
    TEST_ASSERT_TRUE(bearing[0].cwiseAbs().maxCoeff() > 1e-7);
    TEST_ASSERT_TRUE((bearing[1] - expected * bearing[0]).cwiseAbs().maxCoeff() <
                     1e-9 * bearing[0].cwiseAbs().maxCoeff());
  }
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_pixel_should_be_what_its_own_row_sees);
  RUN_TEST(test_jacobians_should_be_exact_by_pose_speeds_and_point);
  RUN_TEST(test_a_new_point_of_a_late_row_should_not_know_its_bearing_better_than_depth_and_speed_together);
  RUN_TEST(test_speeds_should_not_matter_to_a_camera_that_reads_out_at_once);
  return UNITY_END();
}
