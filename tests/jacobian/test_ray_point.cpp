// Corners of a patch on a plane: their Jacobians over the whole state for four lens models and rolling rows, the homography that they are
// for a pinhole, and what they do not observe.
#include "model/reference_camera.h"
#include "same.h"
#include "support/filter_cases.h"
#include "support/test_cameras.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

LensPrior prior_of(Camera* camera) {
  LensSigmas sigmas;
  sigmas.focal = Scalar(0.01);
  sigmas.centre = Scalar(2);
  sigmas.readout = camera->readout / 10;
  sigmas.distortion[0] =
      static_cast<CameraModel>(camera->model) == CameraModel::kDivision ? Scalar(1e-7) : Scalar(0.01);
  return make_lens_prior(sigmas, camera);
}

Camera* rolling(Camera* camera, Scalar readout) {
  camera->readout = readout;
  return camera;
}

BodyLayout layout_of(const LensPrior& prior) {
  BodyLayout layout = BodyLayout::with_constant_velocity();
  if (prior.rows.count > 0) layout.add_constant(BodyPart::kLens, prior.rows.count, false);
  return layout;
}

/// A camera that has moved since it saw a patch on a slanted wall.
struct View {
  LensPrior prior;
  TestFilter filter;
  int camera = -1, wall = -1, patch = -1;
  Vec2 corner[4];

  View(SeededRandom& random, Camera lens, bool uncertain_lens, Scalar readout)
      : prior(uncertain_lens ? prior_of(rolling(&lens, readout)) : LensPrior()), filter(true, layout_of(prior)) {
    lens.readout = readout;
    filter->set_lens(lens, prior);
    Body body = random_body(random);
    filter->set_mean(body);
    PlaneFrame frame;
    frame.o_W = body.p_W + body.q_WC * Vec3(0, 0, 2);
    frame.R_WP = (body.q_WC * random_turn(random, 0.3)).toRotationMatrix();
    wall = filter->add_known_plane(frame, Mat3::Identity(), Scalar(0.01));
    camera = filter->add_reference_camera();
    patch = filter->add_patch(camera, PatchMeasurement::Matrix::Identity());
    TEST_ASSERT_TRUE(wall >= 0 && camera >= 0 && patch >= 0);
    for (int k = 0; k < 4; ++k) {
      const Vec3 at(k == 1 || k == 2 ? Scalar(0.2) : Scalar(-0.2), k >= 2 ? Scalar(0.2) : Scalar(-0.2), 2);
      TEST_ASSERT_TRUE(project(lens, at, &corner[k]));
    }
    body.p_W += random.normals<3>(0.1);
    body.q_WC = random_turn(random, 0.05) * body.q_WC;
    filter->set_mean(body);
    std::vector<Scalar> dx(static_cast<std::size_t>(filter.dim()));
    for (Scalar& d : dx) d = static_cast<Scalar>(0.02 * random.normal());
    for (int i = 0; i < prior.rows.count; ++i)
      dx[static_cast<std::size_t>(filter->state().layout.row(BodyPart::kLens) + i)] = Scalar(0);
    filter.move(dx.data());
  }

  PatchMeasurement predict() {
    PatchMeasurement z;
    TEST_ASSERT_TRUE(filter->predict_patch(filter->lens(), patch, wall, corner, &z));
    return z;
  }
};

void test_corners_should_have_exact_jacobians_over_the_whole_state() {
  SeededRandom random(631);
  for (int trial = 0; trial < 24; ++trial) {
    const Scalar readout = trial / 8 % 2 == 0 ? Scalar(0) : Scalar(0.02);
    View view(random, test_camera_of(trial % kTestCameras), trial / 4 % 2 == 0, readout);
    const State& state = view.filter->state();
    const Dense H = dense_rows(*view.filter, view.predict().H);
    const int n = view.filter.dim();
    const State before = state;
    const std::vector<Block> blocks(state.block, state.block + state.slots);
    for (int row = 0; row < n; ++row) {
      double step = 1e-5;
      for (int i = 0; i < view.prior.rows.count; ++i)
        if (row == state.layout.row(BodyPart::kLens) + i)
          step = 1e-2 * static_cast<double>(std::sqrt(view.prior.variance[i]));
      Eigen::Matrix<double, 8, 1> z[2];
      for (int side = 0; side < 2; ++side) {
        std::vector<Scalar> dx(static_cast<std::size_t>(n), Scalar(0));
        dx[static_cast<std::size_t>(row)] = static_cast<Scalar>(side == 0 ? step : -step);
        view.filter.move(dx.data());
        z[side] = view.predict().predicted.cast<double>();
        const_cast<State&>(state) = before;
        std::copy(blocks.begin(), blocks.end(), state.block);
      }
      const Eigen::Matrix<double, 8, 1> numeric = (z[0] - z[1]) / (2 * step);
      const double size = 1 + numeric.cwiseAbs().maxCoeff();
      // Rolling rows take two rounds to find their time, not all.
      const double tolerance = readout == Scalar(0) ? 1e-6 : 1e-3;
      if (!((numeric - H.col(row)).cwiseAbs().maxCoeff() < tolerance * size)) {
        std::printf("trial %d row %d: off by %g of %g\n", trial, row, (numeric - H.col(row)).cwiseAbs().maxCoeff(),
                    size);
        TEST_FAIL();
      }
    }
  }
}

void test_corners_of_a_pinhole_should_be_those_of_the_homography() {
  SeededRandom random(632);
  for (int trial = 0; trial < 10; ++trial) {
    View view(random, pinhole_camera(), false, Scalar(0));
    const State& state = view.filter->state();
    const Block &reference = state.block[view.camera], &wall = state.block[view.wall];
    const Mat3 R_WK = model::ReferenceCamera::q_WC(reference).toRotationMatrix(),
               R_CW = state.body.q_WC.toRotationMatrix().transpose();
    const Vec3 p_K = model::ReferenceCamera::p_WC(reference);
    Vec3 n_W;
    Scalar d_W;
    plane_normal(state.frame_of(wall), wall.xyz(), &n_W, &d_W);
    const Vec3 n = R_WK.transpose() * n_W, t = R_CW * (p_K - state.body.p_W);
    const Scalar d = d_W - n_W.dot(p_K);
    const Camera& lens = state.lens;
    Mat3 K;
    K << lens.fx, 0, lens.cx, 0, lens.fy, lens.cy, 0, 0, 1;
    const Mat3 H = K * (R_CW * R_WK + t * n.transpose() / d) * K.inverse();
    const PatchMeasurement z = view.predict();
    for (int k = 0; k < 4; ++k) {
      const Block& own = state.block[view.patch];
      const Vec3 p = H * Vec3(view.corner[k].x() + own.value[2 * k], view.corner[k].y() + own.value[2 * k + 1], 1);
      TEST_ASSERT_TRUE((z.predicted.segment<2>(2 * k) - Vec2(p.x() / p.z(), p.y() / p.z())).norm() < Scalar(1e-8));
    }
  }
}

void test_corners_should_say_nothing_about_the_gauge() {
  SeededRandom random(633);
  for (int trial = 0; trial < 8; ++trial) {
    View view(random, test_camera_of(trial % kTestCameras), false, trial < 4 ? Scalar(0) : Scalar(0.02));
    const Dense HN = dense_rows(*view.filter, view.predict().H) * view.filter.gauge();
    TEST_ASSERT_TRUE(HN.cwiseAbs().maxCoeff() < 1e-8);
  }
}

void test_a_patch_should_keep_its_reference_camera() {
  SeededRandom random(634);
  View view(random, pinhole_camera(), false, Scalar(0));
  const State& state = view.filter->state();
  const int n = view.filter.dim();
  const int other = view.filter->add_point(Vec3(0, 0, 1), Mat3::Identity());
  view.filter->remove(&other, 1);
  TEST_ASSERT_SAME(BlockKind::kReferenceCamera, state.block[view.camera].kind);
  view.filter->remove(&view.patch, 1);
  TEST_ASSERT_SAME(BlockKind::kNone, state.block[view.camera].kind);
  TEST_ASSERT_EQUAL_INT(n - 14, view.filter.dim());
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_corners_should_have_exact_jacobians_over_the_whole_state);
  RUN_TEST(test_corners_of_a_pinhole_should_be_those_of_the_homography);
  RUN_TEST(test_corners_should_say_nothing_about_the_gauge);
  RUN_TEST(test_a_patch_should_keep_its_reference_camera);
  return UNITY_END();
}
