// A new point before a plane, where the ray of its pixel meets it: its Jacobian over camera, plane, lens and pixel, for every camera model.
#include "geometry/ray_plane.h"
#include "model/camera_at.h"
#include "support/filter_cases.h"
#include "support/numeric_jacobian.h"
#include "support/test_cameras.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr Scalar kRelativeSigma = Scalar(0.3);
constexpr Scalar kReadout = Scalar(0.03);

LensPrior prior_of(Camera* camera) {
  LensSigmas sigmas;
  sigmas.focal = Scalar(0.01);
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

/// A camera before a slanted wall, and a pixel of it.
struct View {
  LensPrior prior;
  TestFilter filter;
  int wall = -1;
  Vec2 z;
  Scalar tau;

  View(SeededRandom& random, Camera camera, bool uncertain_lens, Scalar tau_)
      : prior(uncertain_lens ? prior_of(rolling(&camera, tau_)) : LensPrior()),
        filter(true, layout_of(prior)),
        tau(tau_) {
    filter->set_lens(*rolling(&camera, tau), prior);
    const Body body = random_body(random);
    filter->set_mean(body);
    PlaneFrame frame;
    frame.o_W = body.p_W + body.q_WC * Vec3(0, 0, 2);
    frame.R_WP = (body.q_WC * random_turn(random, 0.3)).toRotationMatrix();
    wall = filter->add_known_plane(frame, Mat3::Identity(), Scalar(0.01));
    TEST_ASSERT_TRUE(wall >= 0);
    const Vec3 at(static_cast<Scalar>(random.uniform(-0.3, 0.3)), static_cast<Scalar>(random.uniform(-0.3, 0.3)), 2);
    TEST_ASSERT_TRUE(project(camera, at, &z));
    const int n = filter.dim();
    std::vector<Scalar> dx(static_cast<std::size_t>(n));
    for (Scalar& d : dx) d = static_cast<Scalar>(0.02 * random.normal());
    for (int i = 0; i < prior.rows.count; ++i)
      dx[static_cast<std::size_t>(filter->state().layout.row(BodyPart::kLens) + i)] = Scalar(0);
    filter.move(dx.data());
    filter.set_P(random_covariance(random, n, 0.1) + 0.01 * Dense::Identity(n, n));
  }

  /// From the camera's place at the frame's time to where the ray of a pixel meets the wall, times (1 + off) as seen from the camera then.
  Vec3 meets(const Vec2& pixel, Scalar off) {
    const State& state = filter->state();
    Vec3 ray, at;
    TEST_ASSERT_TRUE(unproject(state.lens, pixel, &ray));
    const CameraAt camera = camera_at(state, tau == Scalar(0) ? tau : tau * state.lens.readout / kReadout);
    const Block& block = state.block[wall];
    TEST_ASSERT_TRUE(intersect_ray_plane(state.frame_of(block), block.xyz(), camera.p_W, camera.q_WC * ray, &at));
    return camera.p_W + (1 + off) * (at - camera.p_W) - state.body.p_W;
  }
  int add(const Mat2& noise_px) {
    Vec3 ray;
    Mat32 J_ray_z;
    TEST_ASSERT_TRUE(unproject(filter->lens(), z, &ray, &J_ray_z));
    return filter->add_before_plane(filter->add_anchor(), wall, ray, J_ray_z, noise_px, kRelativeSigma, tau);
  }
};

double largest(const Dense& A) { return A.cwiseAbs().maxCoeff(); }

/// The rows' values of a point that is e from its anchor, about a bearing.
Eigen::Vector3d rows_of(const InverseDepth& about, const Vec3& e) {
  Eigen::Vector3d rows;
  rows.head<2>() = (about.q_b.toRotationMatrix().leftCols<2>().transpose() * e.normalized()).cast<double>();
  rows(2) = 1 / static_cast<double>(e.norm());
  return rows;
}

View view_of(SeededRandom& random, int trial) {
  const Scalar tau = trial / 8 % 2 == 0 ? Scalar(0) : Scalar(0.012);
  return View(random, test_camera_of(trial % kTestCameras), trial / 4 % 2 == 0, tau);
}

void test_a_new_point_should_lie_where_the_ray_meets_the_wall() {
  SeededRandom random(491);
  for (int trial = 0; trial < 16; ++trial) {
    View view = view_of(random, trial);
    const Vec3 e = view.meets(view.z, 0);
    const int slot = view.add(Mat2::Identity());
    TEST_ASSERT_TRUE(slot >= 0);
    TEST_ASSERT_TRUE((view.filter->point(slot) - view.filter->state().body.p_W - e).norm() < Scalar(1e-10));
  }
}

/// Its covariance with the state is J P, held against central differences over every row of the state; its own has the noise of the pixel
/// and of the depth besides.
void test_a_new_point_should_have_an_exact_jacobian_over_the_state_and_its_noise() {
  SeededRandom random(492);
  constexpr double step = 1e-5;
  const Mat2 noise_px = (Mat2() << Scalar(0.3), Scalar(0.1), Scalar(0.1), Scalar(0.2)).finished();
  for (int trial = 0; trial < 32; ++trial) {
    View view = view_of(random, trial);
    const int n = view.filter.dim();
    const Dense P = view.filter.P();
    const State& state = view.filter->state();
    InverseDepth about;
    const Vec3 e = view.meets(view.z, 0);
    about.q_b = turn_z_to(e.normalized());
    Dense J(3, n), unit = Dense::Ones(1, n);
    for (int i = 0; i < view.prior.rows.count; ++i)
      unit(0, state.layout.row(BodyPart::kLens) + i) = 1e3 * static_cast<double>(std::sqrt(view.prior.variance[i]));
    for (int row = 0; row < n; ++row) {
      Eigen::Vector3d moved[2];
      std::vector<Scalar> dx(static_cast<std::size_t>(n), Scalar(0));
      for (int side = 0; side < 2; ++side) {
        Scalar& d = dx[static_cast<std::size_t>(row)];
        d = static_cast<Scalar>((side == 0 ? step : -step) * unit(0, row));
        view.filter.move(dx.data());
        moved[side] = rows_of(about, view.meets(view.z, 0));
        d = -d;
        view.filter.move(dx.data());
      }
      J.col(row) = (moved[0] - moved[1]) / (2 * step * unit(0, row));
    }
    const auto by_pixel = [&](const Vec2& pixel) { return rows_of(about, view.meets(pixel, 0)); };
    Dense J_z(3, 2);
    for (int c = 0; c < 2; ++c) {
      const Vec2 d = Vec2::Unit(c) * Scalar(1e-3);
      J_z.col(c) = (by_pixel(view.z + d) - by_pixel(view.z - d)) / 2e-3;
    }
    const Eigen::Vector3d J_off =
        (rows_of(about, view.meets(view.z, Scalar(step))) - rows_of(about, view.meets(view.z, Scalar(-step)))) /
        (2 * step);
    const int slot = view.add(noise_px);
    const Dense now = view.filter.P();
    const int first = view.filter.first(slot);
    const Dense cross = now.block(first, 0, 3, n), expected = J * P;
    TEST_ASSERT_TRUE(largest(cross - expected) < 1e-5 * largest(expected));
    const Dense own = J * P * J.transpose() + J_z * noise_px.cast<double>() * J_z.transpose() +
                      static_cast<double>(kRelativeSigma * kRelativeSigma) * J_off * J_off.transpose();
    TEST_ASSERT_TRUE(largest(now.block(first, first, 3, 3) - own) < 1e-5 * largest(own));
  }
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_a_new_point_should_lie_where_the_ray_meets_the_wall);
  RUN_TEST(test_a_new_point_should_have_an_exact_jacobian_over_the_state_and_its_noise);
  return UNITY_END();
}
