// Pixels of the window's camera whose rows are read out one after the other: where they lie, and their Jacobians.
#include "bundle/row_column.h"
#include "geometry/so3.h"
#include "keyframe_slam/map/rows.h"
#include "model/camera_at.h"
#include "same.h"
#include "support/numeric_jacobian.h"
#include "support/seeded_random.h"
#include "support/test_cameras.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

using Vec12 = Eigen::Matrix<Scalar, 12, 1>;
constexpr Scalar kReadout = Scalar(0.03);

Body moved_body(Body body, const Vec12& e) {
  body.q_WC = (exp_so3(Vec3(e.head<3>())) * body.q_WC).normalized();
  body.p_W += e.segment<3>(3);
  body.v_W += e.segment<3>(6);
  body.w_C += e.tail<3>();
  return body;
}

Body random_moving_body(SeededRandom& random) {
  Body body;
  body.q_WC = exp_so3(random.normals<3>(0.5));
  body.p_W = random.normals<3>(1.0);
  body.v_W = random.normals<3>(0.5);
  body.w_C = random.normals<3>(0.7);
  return body;
}

Vec3 point_before(const Body& body, SeededRandom& random) {
  const Vec3 in_C(static_cast<Scalar>(random.uniform(-0.4, 0.4)), static_cast<Scalar>(random.uniform(-0.3, 0.3)), 1);
  return body.p_W + body.q_WC * Vec3(in_C * static_cast<Scalar>(random.uniform(1, 4)));
}

Camera rolling_camera(int trial) {
  Camera camera = test_camera_of(trial % kTestCameras);
  camera.readout = kReadout;
  return camera;
}

void test_jacobian_by_pose_and_velocities_should_be_exact() {
  SeededRandom random(151);
  for (int trial = 0; trial < 40; ++trial) {
    const Camera camera = rolling_camera(trial);
    const Body body = random_moving_body(random);
    const Vec3 p_W = point_before(body, random);
    const Scalar w = static_cast<Scalar>(random.uniform(0.2, 1)),
                 tau = static_cast<Scalar>(random.uniform(-0.015, 0.015));
    Vec2 z;
    Mat212 J;
    TEST_ASSERT_TRUE(project_moving(camera, body, tau, w * p_W, w, &z, &J));
    check_jacobian<2, 12>(
        J,
        [&](const Vec12& e) {
          Vec2 moved;
          TEST_ASSERT_TRUE(project_moving(camera, moved_body(body, e), tau, w * p_W, w, &moved));
          return moved;
        },
        "J_pixel_body");
  }
}

/// The pixel is where the camera of its own row's time sees the point, and comes back to where it is at the frame's time.
void test_pixel_should_be_what_its_own_row_sees() {
  SeededRandom random(152);
  for (int trial = 0; trial < 40; ++trial) {
    const Camera camera = rolling_camera(trial);
    const Body body = random_moving_body(random);
    const Vec3 p_W = point_before(body, random);
    Vec2 z, still, by_row;
    TEST_ASSERT_TRUE(project_row(camera, body, p_W, Scalar(1), &z));
    const Scalar tau = row_time(camera, z.y());
    TEST_ASSERT_TRUE(project(
        camera, (body.q_WC * exp_so3(body.w_C * tau)).conjugate() * (p_W - body.p_W - body.v_W * tau), &by_row));
    TEST_ASSERT_TRUE((z - by_row).norm() < Scalar(0.05));
    TEST_ASSERT_TRUE(project(camera, body.q_WC.conjugate() * (p_W - body.p_W), &still));
    TEST_ASSERT_TRUE((at_frame_time(camera, body, p_W, Scalar(1), z) - still).norm() < Scalar(0.05));
  }
}

void test_pixel_should_stay_where_it_is_when_all_rows_are_read_out_at_once() {
  SeededRandom random(153);
  const Body body = random_moving_body(random);
  const Vec2 z(100, 20);
  TEST_ASSERT_SAME(z, at_frame_time(test_camera_of(0), body, point_before(body, random), Scalar(1), z));
}

/// Of a pixel that is measured in its row, at the frame's time: the less readout, the nearer it is to where it was measured.
void test_column_of_the_readout_should_be_exact() {
  SeededRandom random(155);
  for (int trial = 0; trial < 40; ++trial) {
    Camera camera = rolling_camera(trial);
    camera.readout = Scalar(0);
    const Body body = random_moving_body(random);
    const Vec3 p_W = point_before(body, random);
    const Scalar rho = 1 / (p_W - body.p_W).norm();
    const Vec3 m = rho * p_W;
    Vec2 z;
    Mat23 J;
    const Mat3 R_CW = body.q_WC.toRotationMatrix().transpose();
    const Vec3 d = rho * (p_W - body.p_W);
    TEST_ASSERT_TRUE(project(camera, R_CW * d, &z, &J));
    const ViewOfRows view = {R_CW, {body.v_W, body.w_C}, Scalar(0)};
    const Vec2 column = readout_column(camera, view, z.y(), J * R_CW, d, rho);
    using One = Eigen::Matrix<Scalar, 1, 1>;
    check_jacobian<2, 1>(
        Vec2(-column),
        [&](const One& e) {
          Camera rolling = camera;
          rolling.readout = e(0);
          return at_frame_time(rolling, body, m, rho, z);
        },
        "J_pixel_readout");
    const Scalar bound = sizeof(Scalar) == sizeof(float) ? Scalar(0.05) : Scalar(1e-8);
    TEST_ASSERT_TRUE((readout_column(camera, view, z, rho) - column).norm() < bound);
  }
}

/// By a readout that is not zero the row is that of the pixel at its own time, and not that of the frame's.
void test_column_should_be_that_of_the_row_in_which_the_pixel_was_read_out() {
  SeededRandom random(156);
  for (int trial = 0; trial < 40; ++trial) {
    const Camera camera = rolling_camera(trial);
    const Body body = random_moving_body(random);
    const Vec3 p_W = point_before(body, random);
    Vec2 measured;
    if (!project_row(camera, body, p_W, Scalar(1), &measured)) continue;
    const Vec2 z = at_frame_time(camera, body, p_W, Scalar(1), measured);
    const Mat3 R_CW = body.q_WC.toRotationMatrix().transpose();
    Vec2 still;
    Mat23 J;
    TEST_ASSERT_TRUE(project(camera, R_CW * (p_W - body.p_W), &still, &J));
    const Vec2 column = readout_column(camera, {R_CW, {body.v_W, body.w_C}, Scalar(0)}, measured.y(), J * R_CW,
                                       p_W - body.p_W, Scalar(1));
    const ViewOfRows view = {R_CW, {body.v_W, body.w_C}, camera.readout};
    const Vec2 found = readout_column(camera, view, z, 1 / (p_W - body.p_W).norm());
    TEST_ASSERT_TRUE((found - column).norm() < Scalar(0.02) * column.norm() + Scalar(0.1));
  }
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_jacobian_by_pose_and_velocities_should_be_exact);
  RUN_TEST(test_pixel_should_be_what_its_own_row_sees);
  RUN_TEST(test_pixel_should_stay_where_it_is_when_all_rows_are_read_out_at_once);
  RUN_TEST(test_column_of_the_readout_should_be_exact);
  RUN_TEST(test_column_should_be_that_of_the_row_in_which_the_pixel_was_read_out);
  return UNITY_END();
}
