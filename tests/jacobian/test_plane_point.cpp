// A new point of a plane, where the ray of its pixel meets it: its Jacobian over camera, plane, lens and pixel, for every camera model.
#include "geometry/ray_plane.h"
#include "model/camera_at.h"
#include "same.h"
#include "support/filter_cases.h"
#include "support/numeric_jacobian.h"
#include "support/test_cameras.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr Scalar kRoughness = Scalar(0.01);
constexpr Scalar kReadout = Scalar(0.03);

LensPrior prior_of(Camera* camera) {
  LensSigmas sigmas;
  sigmas.focal = Scalar(0.01);
  sigmas.aspect = Scalar(0.001);
  sigmas.centre = Scalar(2);
  sigmas.readout = camera->readout / 10;
  sigmas.distortion[0] =
      static_cast<CameraModel>(camera->model) == CameraModel::kDivision ? Scalar(1e-7) : Scalar(0.01);
  return make_lens_prior(sigmas, camera);
}

/// Its rows take their time where one is asked for.
Camera* rolling(Camera* camera, Scalar tau) {
  if (tau != Scalar(0)) camera->readout = kReadout;
  return camera;
}

BodyLayout layout_of(const LensPrior& prior) {
  BodyLayout layout = BodyLayout::with_constant_velocity();
  if (prior.rows.count > 0) layout.add_constant(BodyPart::kLens, prior.rows.count, false);
  return layout;
}

/// A camera in front of a slanted plane, and a pixel in which it sees a point of it.
struct View {
  LensPrior prior;
  TestFilter filter;
  int plane = -1;
  Vec2 z;
  Scalar tau;

  View(SeededRandom& random, Camera camera, bool uncertain_lens, Scalar tau_)
      : prior(uncertain_lens ? prior_of(rolling(&camera, tau_)) : LensPrior()),
        filter(true, layout_of(prior)),
        tau(tau_) {
    filter->set_lens(*rolling(&camera, tau), prior);
    filter->set_roughness(kRoughness);
    const Body body = random_body(random);
    filter->set_mean(body);
    const Vec3 middle = body.p_W + body.q_WC * Vec3(0, 0, 2);
    const Mat3 R = (body.q_WC * random_turn(random, 0.3)).toRotationMatrix();
    Vec3 point[6];
    int slot[6];
    for (int i = 0; i < 6; ++i) {
      point[i] = middle + R * Vec3(static_cast<Scalar>(random.uniform(-0.5, 0.5)),
                                   static_cast<Scalar>(random.uniform(-0.5, 0.5)), 0);
      slot[i] = filter->add_point(point[i], Mat3::Identity());
    }
    PlaneFit fit;
    TEST_ASSERT_TRUE(fit_plane(point, 6, body.p_W, &fit));
    plane = filter->add_plane(fit, slot, 6, Scalar(0));
    TEST_ASSERT_TRUE(plane >= 0);
    TEST_ASSERT_TRUE(project(camera, body.q_WC.conjugate() * (point[0] - body.p_W), &z));
    const int n = filter.dim();
    std::vector<Scalar> dx(static_cast<std::size_t>(n));
    for (Scalar& d : dx) d = static_cast<Scalar>(0.02 * random.normal());
    for (int i = 0; i < prior.rows.count; ++i)
      dx[static_cast<std::size_t>(filter->state().layout.row(BodyPart::kLens) + i)] = Scalar(0);
    filter.move(dx.data());
    filter.set_P(random_covariance(random, n, 0.1) + 0.01 * Dense::Identity(n, n));
  }

  /// Where the ray of a pixel meets the surface, `lift` above the plane along its normal.
  Vec2 meets(const Vec2& pixel, Scalar lift) {
    const State& state = filter->state();
    Vec3 ray, at;
    TEST_ASSERT_TRUE(unproject(state.lens, pixel, &ray));
    const CameraAt camera = camera_at(state, tau == Scalar(0) ? tau : tau * state.lens.readout / kReadout);
    const Block& block = state.block[plane];
    Vec3 x = block.xyz();
    x.z() += lift * Vec3(x.x(), x.y(), 1).norm();
    TEST_ASSERT_TRUE(intersect_ray_plane(state.frame_of(block), x, camera.p_W, camera.q_WC * ray, &at));
    return plane_coordinates(state.frame_of(block), at);
  }
  int add(const Mat2& noise_px) {
    Vec3 ray;
    Mat32 J_ray_z;
    TEST_ASSERT_TRUE(unproject(filter->lens(), z, &ray, &J_ray_z));
    return filter->add_plane_point(plane, ray, J_ray_z, noise_px, tau);
  }
};

void test_a_new_plane_point_should_lie_where_the_ray_meets_the_plane() {
  SeededRandom random(481);
  for (int trial = 0; trial < 20; ++trial) {
    View view(random, test_camera_of(trial % kTestCameras), trial % 2 == 0, Scalar(0));
    const int slot = view.add(Mat2::Identity());
    TEST_ASSERT_TRUE(slot >= 0);
    TEST_ASSERT_EQUAL_INT(view.plane, view.filter->state().plane_of(slot));
    PixelMeasurement o;
    TEST_ASSERT_TRUE(view.filter->predict_pixel(view.filter->lens(), slot, &o));
    TEST_ASSERT_TRUE((o.predicted - view.z).norm() < Scalar(1e-6));
  }
}

/// Its covariance with the state is J P, so J is read off and held against central differences of every row of the state.
void test_a_new_plane_point_should_have_an_exact_jacobian_over_the_state() {
  SeededRandom random(482);
  constexpr double step = 1e-5;
  for (int trial = 0; trial < 32; ++trial) {
    const Scalar tau = trial / 8 % 2 == 0 ? Scalar(0) : Scalar(0.012);
    View view(random, test_camera_of(trial % kTestCameras), trial / 4 % 2 == 0, tau);
    const int n = view.filter.dim();
    const Dense P = view.filter.P();
    const State& state = view.filter->state();
    Dense numeric(2, n), unit = Dense::Ones(1, n);
    // A distortion in pixels^-2 needs a step of its own.
    for (int i = 0; i < view.prior.rows.count; ++i)
      unit(0, state.layout.row(BodyPart::kLens) + i) = static_cast<double>(std::sqrt(view.prior.variance[i]));
    for (int row = 0; row < n; ++row) {
      Eigen::Vector2d uv[2];
      std::vector<Scalar> dx(static_cast<std::size_t>(n), Scalar(0));
      for (int side = 0; side < 2; ++side) {
        Scalar& d = dx[static_cast<std::size_t>(row)];
        d = static_cast<Scalar>((side == 0 ? step : -step) * unit(0, row));
        view.filter.move(dx.data());
        uv[side] = view.meets(view.z, Scalar(0)).cast<double>();
        d = -d;
        view.filter.move(dx.data());
      }
      numeric.col(row) = (uv[0] - uv[1]) / (2 * step);
    }
    const int slot = view.add(Mat2::Identity());
    TEST_ASSERT_TRUE(slot >= 0);
    TEST_ASSERT_EQUAL_INT(n + 2, view.filter.dim());
    const Dense J = view.filter.P().block(view.filter.first(slot), 0, 2, n) * inverse_of(P) * unit.row(0).asDiagonal();
    TEST_ASSERT_TRUE(numeric.leftCols(6).cwiseAbs().maxCoeff() > 0.5);
    if (tau > Scalar(0)) TEST_ASSERT_TRUE(numeric.block(0, kVelocityRow, 2, 6).cwiseAbs().maxCoeff() > 0.005);
    for (int row = 0; row < n; ++row)
      for (int i = 0; i < 2; ++i) {
        if (std::abs(J(i, row) - numeric(i, row)) < 1e-6 * (1 + std::abs(numeric(i, row)))) continue;
        char text[120];
        std::snprintf(text, sizeof text, "trial %d: J(%d, %d) is %.9g, numerically %.9g", trial, i, row, J(i, row),
                      numeric(i, row));
        TEST_FAIL_MESSAGE(text);
      }
  }
}

/// What no row of the state explains: the pixel's noise and the surface's roughness.
void test_a_new_plane_point_should_have_the_noise_of_its_pixel_and_of_the_surface() {
  SeededRandom random(483);
  for (int trial = 0; trial < 20; ++trial) {
    View view(random, test_camera_of(trial % kTestCameras), false, Scalar(0));
    const Mat2 J_z = numeric_jacobian<2, 2>([&](const Vec2& e) { return view.meets(view.z + e, 0); }, Scalar(0.1));
    const Eigen::Matrix<Scalar, 2, 1> J_lift = numeric_jacobian<2, 1>(
        [&](const Eigen::Matrix<Scalar, 1, 1>& e) { return view.meets(view.z, e(0)); }, Scalar(1e-3));
    Mat2 noise_px;
    noise_px << Scalar(0.5), Scalar(0.1), Scalar(0.1), Scalar(0.3);
    view.filter.set_P(Dense::Zero(view.filter.dim(), view.filter.dim()));
    const int slot = view.add(noise_px);
    const Mat2 expected = J_z * noise_px * J_z.transpose() + kRoughness * kRoughness * J_lift * J_lift.transpose();
    const Mat2 found = view.filter.P().block<2, 2>(view.filter.first(slot), view.filter.first(slot)).cast<Scalar>();
    TEST_ASSERT_TRUE((found - expected).norm() < Scalar(1e-6) * expected.norm());
  }
}

void test_no_plane_point_should_begin_where_the_ray_meets_no_plane() {
  SeededRandom random(484);
  View view(random, pinhole_camera(), false, Scalar(0));
  const int n = view.filter.dim();
  const Dense P = view.filter.P();
  TEST_ASSERT_EQUAL_INT(-1, view.filter->add_plane_point(view.plane, Vec3(0, 0, -1), Mat32::Zero(), Mat2::Identity()));
  TEST_ASSERT_EQUAL_INT(n, view.filter.dim());
  TEST_ASSERT_SAME(P, view.filter.P());
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_a_new_plane_point_should_lie_where_the_ray_meets_the_plane);
  RUN_TEST(test_a_new_plane_point_should_have_an_exact_jacobian_over_the_state);
  RUN_TEST(test_a_new_plane_point_should_have_the_noise_of_its_pixel_and_of_the_surface);
  RUN_TEST(test_no_plane_point_should_begin_where_the_ray_meets_no_plane);
  return UNITY_END();
}
