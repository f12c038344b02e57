// Jacobians by the numbers of the calibration: of a pixel, of a ray, of a predicted pixel, of a new bearing, and of a pose that was
// fitted to known points; for every camera model.
#include "bundle/bearing.h"
#include "geometry/lens.h"
#include "geometry/planar_pose.h"
#include "geometry/so3.h"
#include "model/camera_at.h"
#include "support/filter_cases.h"
#include "support/numeric_jacobian.h"
#include "support/test_cameras.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

using Parameters = Eigen::Matrix<Scalar, kLensParameters, 1>;

/// Every parameter that the model has, with sigmas that make a unit step of the scaled parameters a small one.
LensPrior prior_of(Camera* camera) {
  LensSigmas sigmas;
  sigmas.focal = Scalar(0.01);
  sigmas.aspect = Scalar(0.001);
  sigmas.centre = Scalar(2);
  sigmas.readout = camera->readout / 10;
  const CameraModel model = static_cast<CameraModel>(camera->model);
  const int count = model == CameraModel::kRadtan ? 5 : model == CameraModel::kEquidistant ? 4 : 1;
  for (int i = 0; i < count; ++i) sigmas.distortion[i] = model == CameraModel::kDivision ? Scalar(1e-7) : Scalar(0.01);
  return make_lens_prior(sigmas, camera);
}

Parameters sigmas_of(const LensPrior& prior) {
  Parameters sigma = Parameters::Zero();
  for (int i = 0; i < prior.rows.count; ++i) sigma(prior.rows.parameter[i]) = std::sqrt(prior.variance[i]);
  return sigma;
}

/// The camera with its parameters moved by e sigmas.
Camera with(const Camera& camera, const LensPrior& prior, const Parameters& e) {
  const Parameters sigma = sigmas_of(prior);
  Scalar step[kLensParameters];
  for (int i = 0; i < prior.rows.count; ++i) step[i] = e(prior.rows.parameter[i]) * sigma(prior.rows.parameter[i]);
  Camera out = camera;
  move_lens(prior.rows, step, &out);
  return out;
}

/// Columns by parameters in units of their sigmas.
template <int kRows>
Eigen::Matrix<Scalar, kRows, kLensParameters> scaled(const Eigen::Matrix<Scalar, kRows, kLensParameters>& J,
                                                     const LensPrior& prior) {
  return J * sigmas_of(prior).asDiagonal();
}

constexpr Scalar kTolerance = kNumericJacobianIsFloat ? Scalar(2e-3) : Scalar(1e-7);

void test_pixel_and_ray_should_have_exact_jacobians_by_the_lens() {
  SeededRandom random(471);
  for (int trial = 0; trial < 80; ++trial) {
    Camera camera = test_camera_of(trial % kTestCameras);
    const LensPrior prior = prior_of(&camera);
    const Vec3 p_C(static_cast<Scalar>(random.uniform(-0.5, 0.5)), static_cast<Scalar>(random.uniform(-0.5, 0.5)), 1);
    const auto pixel = [&](const Parameters& e) {
      Vec2 z;
      TEST_ASSERT_TRUE(project(with(camera, prior, e), p_C, &z));
      return z;
    };
    check_jacobian<2, kLensParameters>(scaled<2>(lens_jacobian(camera, p_C), prior), pixel, "J_pixel_lens", 1,
                                       kTolerance);
    Vec2 z;
    Vec3 ray;
    Mat32 J_ray_pixel;
    TEST_ASSERT_TRUE(project(camera, p_C, &z));
    TEST_ASSERT_TRUE(unproject(camera, z, &ray, &J_ray_pixel));
    const auto ray_of = [&](const Parameters& e) {
      Vec3 r;
      TEST_ASSERT_TRUE(unproject(with(camera, prior, e), z, &r));
      return r;
    };
    check_jacobian<3, kLensParameters>(scaled<3>(ray_lens_jacobian(camera, ray, J_ray_pixel), prior), ray_of,
                                       "J_ray_lens", 1, kTolerance);
  }
}

/// Of the bundle adjuster: the pixel and the bearing in the host were seen through one lens.
void test_pixel_of_a_bearing_should_have_an_exact_jacobian_by_the_lens() {
  SeededRandom random(475);
  for (int trial = 0; trial < 40; ++trial) {
    Camera camera = test_camera_of(trial % kTestCameras);
    const LensPrior prior = prior_of(&camera);
    const Mat3 R_CW = exp_so3(random.normals<3>(0.1)).toRotationMatrix();
    const Mat3 R_WH = exp_so3(random.normals<3>(0.1)).toRotationMatrix();
    const Vec3 p_HC_W = random.normals<3>(0.1);
    const Scalar rho = static_cast<Scalar>(random.uniform(0.1, 1));
    Vec3 ray(0, 0, 1);
    ray.head<2>() = random.normals<2>(0.1);
    Vec2 host, z;
    Mat32 J_ray_host;
    TEST_ASSERT_TRUE(project(camera, ray, &host) && unproject(camera, host, &ray, &J_ray_host));
    const auto pixel = [&](const Parameters& e) {
      const Camera moved = with(camera, prior, e);
      Vec3 r;
      Vec2 at;
      TEST_ASSERT_TRUE(unproject(moved, host, &r));
      TEST_ASSERT_TRUE(project(moved, R_CW * (R_WH * r + rho * p_HC_W), &at));
      return at;
    };
    const Vec3 d_C = R_CW * (R_WH * ray + rho * p_HC_W);
    Mat23 J_z_d_C;
    TEST_ASSERT_TRUE(project(camera, d_C, &z, &J_z_d_C));
    const RayByLens J_ray_W = R_WH * ray_lens_jacobian(camera, ray, J_ray_host);
    check_jacobian<2, kLensParameters>(
        scaled<2>(bearing_lens_jacobian(camera, d_C, J_z_d_C.lazyProduct(R_CW), J_ray_W), prior), pixel,
        "J_bearing_lens", 1, kTolerance);
  }
}

BodyLayout layout_of(const LensPrior& prior) {
  BodyLayout layout = BodyLayout::with_constant_velocity();
  layout.add_constant(BodyPart::kLens, prior.rows.count, false);
  return layout;
}

/// Lens columns of a dense Jacobian over the state, as columns by all parameters.
Eigen::Matrix<Scalar, 2, kLensParameters> lens_columns(const Dense& H, const LensPrior& prior, int first) {
  Eigen::Matrix<Scalar, 2, kLensParameters> J = Eigen::Matrix<Scalar, 2, kLensParameters>::Zero();
  for (int i = 0; i < prior.rows.count; ++i) J.col(prior.rows.parameter[i]) = H.col(first + i).cast<Scalar>();
  return J;
}

void test_predicted_pixels_should_have_exact_jacobians_by_the_lens() {
  SeededRandom random(472);
  for (int trial = 0; trial < 40; ++trial) {
    Camera camera = test_camera_of(trial % kTestCameras);
    camera.readout = trial % 2 == 0 ? Scalar(0) : Scalar(0.03);
    const LensPrior prior = prior_of(&camera);
    const BodyLayout layout = layout_of(prior);
    TestFilter filter(true, layout);
    filter->set_lens(camera, prior);
    for (const int slot : fill_map(random, filter, 2, 2)) {
      const auto predicted = [&](const Parameters& e) {
        PixelMeasurement o;
        TEST_ASSERT_TRUE(filter->predict_pixel(with(camera, prior, e), slot, &o));
        return o.predicted;
      };
      PixelMeasurement o;
      TEST_ASSERT_TRUE(filter->predict_pixel(camera, slot, &o));
      const Dense H = dense_rows(*filter, o.H);
      check_jacobian<2, kLensParameters>(scaled<2>(lens_columns(H, prior, layout.row(BodyPart::kLens)), prior),
                                         predicted, "J_z_lens", 1,
                                         camera.readout > Scalar(0) ? Scalar(4e-3) : kTolerance);
    }
  }
}

/// A new bearing's covariance with the lens is J times the prior.
void test_new_bearings_should_have_exact_jacobians_by_the_lens() {
  SeededRandom random(473);
  for (int trial = 0; trial < 40; ++trial) {
    Camera camera = test_camera_of(trial % kTestCameras);
    camera.readout = trial / 4 % 2 == 0 ? Scalar(0) : Scalar(0.03);
    const LensPrior prior = prior_of(&camera);
    const BodyLayout layout = layout_of(prior);
    TestFilter filter(true, layout);
    filter->set_lens(camera, prior);
    const Body body = random_body(random);
    filter->set_mean(body);
    Vec2 z;
    TEST_ASSERT_TRUE(project(camera, body.q_WC.conjugate() * (point_in_view(random, body) - body.p_W), &z));
    constexpr Scalar kRho = Scalar(0.5);
    /// From the anchor towards the point, whose pixel was read out at its row's own time.
    const auto seen_from_anchor = [&](const Camera& c) -> Vec3 {
      Vec3 ray;
      TEST_ASSERT_TRUE(unproject(c, z, &ray));
      const CameraAt then = camera_at(filter->state(), row_time(c, z.y()));
      return (then.q_WC * ray + kRho * (then.p_W - body.p_W)).normalized();
    };
    Vec3 ray;
    Mat32 J_ray_z;
    TEST_ASSERT_TRUE(unproject(camera, z, &ray, &J_ray_z));
    const int anchor = filter->add_anchor();
    const int slot =
        filter->add_inverse_depth(anchor, ray, J_ray_z, Mat2::Identity(), kRho, Scalar(0.1), row_time(camera, z.y()));
    const Mat3 R_b = filter->state().block[slot].inverse_depth().q_b.toRotationMatrix();
    const auto bearing_error = [&](const Parameters& e) -> Vec2 {
      return R_b.leftCols<2>().transpose() * seen_from_anchor(with(camera, prior, e));
    };
    const int first = layout.row(BodyPart::kLens), count = prior.rows.count;
    const Dense P = filter.P();
    const Dense J = P.block(filter.first(slot), first, 2, count) * inverse_of(P.block(first, first, count, count));
    check_jacobian<2, kLensParameters>(scaled<2>(lens_columns(J, prior, 0), prior), bearing_error, "J_bearing_lens", 1,
                                       kNumericJacobianIsFloat ? Scalar(4e-3) : Scalar(1e-7));
  }
}

void test_poses_from_known_points_should_have_exact_jacobians_by_the_lens() {
  SeededRandom random(474);
  for (int trial = 0; trial < 12; ++trial) {
    Camera camera = test_camera_of(trial % kTestCameras);
    const LensPrior prior = prior_of(&camera);
    PoseEstimate truth;
    truth.q_WC = random_turn(random, 0.2);
    truth.p_WC = Vec3(Scalar(0.1), Scalar(-0.2), -2) + random.normals<3>(0.1);
    Vec3 corners[4];
    Vec2 z[4];
    rectangle_points(Scalar(0.8), Scalar(0.6), corners);
    corners[3].z() = Scalar(0.3);  // not in a plane, so that the pose is firm
    for (int i = 0; i < 4; ++i)
      TEST_ASSERT_TRUE(project(camera, truth.q_WC.conjugate() * (corners[i] - truth.p_WC), &z[i]));
    Scalar raw[6 * kLensParameters];
    TEST_ASSERT_TRUE(pose_by_lens(camera, corners, 4, truth, prior.rows, raw));
    Eigen::Matrix<Scalar, 6, kLensParameters> J = Eigen::Matrix<Scalar, 6, kLensParameters>::Zero();
    for (int a = 0; a < 6; ++a)
      for (int i = 0; i < prior.rows.count; ++i) J(a, prior.rows.parameter[i]) = raw[a * prior.rows.count + i];
    const auto fitted = [&](const Parameters& e) {
      PoseEstimate pose = truth;
      TEST_ASSERT_TRUE(refine_pose(with(camera, prior, e), corners, z, 4, Scalar(0.25), &pose));
      Vec6 error;
      error << log_so3(pose.q_WC * truth.q_WC.conjugate()), pose.p_WC - truth.p_WC;
      return error;
    };
    // Gauss-Newton leaves out the curvature times the residuals of a lens that does not fit, which is of second order here.
    check_jacobian<6, kLensParameters>(scaled<6>(J, prior), fitted, "J_pose_lens", 1,
                                       kNumericJacobianIsFloat ? Scalar(2e-2) : Scalar(1e-6));
  }
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_pixel_and_ray_should_have_exact_jacobians_by_the_lens);
  RUN_TEST(test_pixel_of_a_bearing_should_have_an_exact_jacobian_by_the_lens);
  RUN_TEST(test_predicted_pixels_should_have_exact_jacobians_by_the_lens);
  RUN_TEST(test_new_bearings_should_have_exact_jacobians_by_the_lens);
  RUN_TEST(test_poses_from_known_points_should_have_exact_jacobians_by_the_lens);
  return UNITY_END();
}
