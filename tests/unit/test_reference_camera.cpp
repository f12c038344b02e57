// A reference camera: begun with all that the camera has in common with the rest, kept while it is needed, removed without a trace.
#include "filter/known_camera.h"
#include "model/reference_camera.h"
#include "same.h"
#include "support/filter_scene.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

Dense motion_covariance(const TestFilter& filter, int camera) {
  Quat q_KC;
  Vec3 p_KC;
  Mat6 covariance;
  (*filter).motion_since(camera, &q_KC, &p_KC, &covariance);
  return covariance.cast<double>();
}

void test_a_new_one_should_be_the_camera_with_its_full_correlation() {
  SeededRandom random(511);
  for (int trial = 0; trial < 10; ++trial) {
    Scene scene(random, true);
    const Dense before = scene.filter.P();
    const int n = scene.filter.dim();
    const int camera = scene.filter->add_reference_camera();
    TEST_ASSERT_TRUE(camera >= 0);
    TEST_ASSERT_EQUAL_INT(n + 6, scene.filter.dim());
    const int first = scene.filter.first(camera);
    const Dense P = scene.filter.P();
    TEST_ASSERT_SAME(0, largest(P.topLeftCorner(n, n) - before));
    TEST_ASSERT_TRUE(difference(P.block(first, first, 6, 6), before.topLeftCorner(6, 6)) < kExact);
    TEST_ASSERT_TRUE(largest(P.block(first, 0, 6, n) - before.topRows(6)) < kExact);
    const Block& block = scene.filter->state().block[camera];
    TEST_ASSERT_SAME(Scalar(0), (model::ReferenceCamera::p_WC(block) - scene.filter->state().body.p_W).norm());
    TEST_ASSERT_TRUE((model::ReferenceCamera::q_WC(block).coeffs() - scene.filter->state().body.q_WC.coeffs()).norm() <
                     Scalar(1e-15));
    TEST_ASSERT_TRUE(largest(motion_covariance(scene.filter, camera)) < 1e-12);
  }
}

void test_a_prediction_should_leave_it_and_give_the_motion_the_noise() {
  SeededRandom random(512);
  Scene scene(random, true);
  const int camera = scene.filter->add_reference_camera();
  const Block before = scene.filter->state().block[camera];
  Transition t;
  predict_constant_position(scene.filter->state().body, BodyLayout::with_constant_velocity(), Scalar(0.05), {1, 2}, &t);
  scene.filter->predict(t);
  const Block& block = scene.filter->state().block[camera];
  for (int i = 0; i < 7; ++i) TEST_ASSERT_SAME(before.value[i], block.value[i]);
  // A walk has no F but the identity on the pose, so the motion is its noise, turned into K.
  const Mat3 R = model::ReferenceCamera::q_WC(block).toRotationMatrix().transpose();
  Dense Q(6, 6), J = Dense::Zero(6, 6);
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) Q(i, j) = static_cast<double>(t.Q[i * t.dim + j]);
  J.topLeftCorner(3, 3) = J.bottomRightCorner(3, 3) = R.cast<double>();
  const Dense expected = J * Q * J.transpose();
  TEST_ASSERT_TRUE(largest(motion_covariance(scene.filter, camera) - expected) < 1e-12);
}

void test_it_should_stay_while_it_is_pinned_and_go_without_a_trace() {
  SeededRandom random(513);
  Scene scene(random, true);
  const State& state = scene.filter->state();
  const int n = scene.filter.dim();
  const Dense before = scene.filter.P();
  const int camera = scene.filter->add_reference_camera();
  scene.filter->pin(camera);
  const int gone[2] = {scene.slots[1], scene.slots[7]};
  scene.filter->remove(gone, 2);
  TEST_ASSERT_SAME(BlockKind::kReferenceCamera, state.block[camera].kind);
  TEST_ASSERT_EQUAL_INT(n, scene.filter.dim());  // less two features of three rows
  scene.filter->pin(camera);
  scene.filter->unpin(camera);
  TEST_ASSERT_SAME(BlockKind::kReferenceCamera, state.block[camera].kind);
  scene.filter->unpin(camera);
  TEST_ASSERT_SAME(BlockKind::kNone, state.block[camera].kind);
  TEST_ASSERT_EQUAL_INT(n - 6, scene.filter.dim());
  PixelMeasurement o;  // the others are where they say that they are
  for (const int slot : scene.slots)
    if (state.block[slot].kind != BlockKind::kNone) {
      TEST_ASSERT_TRUE(scene.filter->predict_pixel(pinhole_camera(), slot, &o));
      const int first = scene.filter.first(slot);
      TEST_ASSERT_SAME(0, std::fabs(before(0, 0) - scene.filter.P()(0, 0)));
      TEST_ASSERT_TRUE(first + 3 <= scene.filter.dim());
    }
}

void test_one_that_nothing_needs_should_go_with_the_next_removal() {
  SeededRandom random(514);
  Scene scene(random, true);
  const int camera = scene.filter->add_reference_camera();
  scene.filter->remove(scene.slots.data(), 1);
  TEST_ASSERT_SAME(BlockKind::kNone, scene.filter->state().block[camera].kind);
}

void test_an_update_should_move_it_by_its_own_rows() {
  SeededRandom random(515);
  for (const bool keep_gauge : {false, true}) {
    Scene scene(random, keep_gauge);
    const int camera = scene.filter->add_reference_camera();
    scene.filter->pin(camera);
    scene.filter.set_P(random_covariance(random, scene.filter.dim(), 0.02));
    const Body body = scene.filter->state().body;
    const Block before = scene.filter->state().block[camera];
    const Dense P = scene.filter.P();
    const int n = scene.filter.dim(), m = 2 * scene.count();
    Dense H(m, n), R = Dense::Zero(m, m);
    Eigen::VectorXd y(m);
    for (int i = 0; i < scene.count(); ++i) {
      const PixelMeasurement& o = scene.observations[static_cast<std::size_t>(i)];
      H.middleRows(2 * i, 2) = dense_rows(*scene.filter, o.H);
      R.block(2 * i, 2 * i, 2, 2) = o.R_update.cast<double>();
      y.segment(2 * i, 2) = (o.measured - o.predicted).cast<double>();
    }
    const Eigen::VectorXd dx = P * H.transpose() * inverse_of(H * P * H.transpose() + R) * y;
    scene.filter->begin_update(scene.observations.data(), scene.count());
    TEST_ASSERT_TRUE(scene.filter->finish_update(scene.observations.data(), scene.count(), nullptr, nullptr));
    const Block& block = scene.filter->state().block[camera];
    const Eigen::VectorXd e = dx.segment(scene.filter.first(camera), 6);
    TEST_ASSERT_TRUE(
        ((model::ReferenceCamera::p_WC(block) - model::ReferenceCamera::p_WC(before)).cast<double>() - e.tail(3))
            .norm() < 1e-9);
    const Vec3 theta = log_so3(model::ReferenceCamera::q_WC(block) * model::ReferenceCamera::q_WC(before).conjugate());
    TEST_ASSERT_TRUE((theta.cast<double>() - e.head(3)).norm() < 1e-9);
    TEST_ASSERT_TRUE((scene.filter->state().body.p_W - body.p_W).norm() > Scalar(0));
  }
}

void test_a_full_filter_should_refuse_it_and_stay_as_it_is() {
  SeededRandom random(516);
  TestFilter filter(true, BodyLayout::with_constant_velocity(), 32, 6);
  while (filter->room() >= 6) filter->add_point(random.normals<3>(1), Mat3::Identity());
  const std::vector<Scalar> before = bits_of(filter);
  TEST_ASSERT_EQUAL_INT(-1, filter->add_reference_camera());
  TEST_ASSERT_SAME(bits_of(filter), before);
}

Mat6 drawn_covariance(SeededRandom& random) {
  Mat6 A;
  for (int c = 0; c < 6; ++c) A.col(c) = random.normals<6>(Scalar(0.05));
  return A * A.transpose();
}

/// A known camera K, with its anchor and a point that it knows.
struct KnownPoint {
  int camera, anchor, slot;
};

KnownPoint add_known(TestFilter& filter, const Quat& q_WK, const Vec3& p_WK, const Mat6& C_K, const Vec3& x_K,
                     const Mat3& C_x) {
  KnownPoint out;
  out.camera = filter->add_known_camera(q_WK, p_WK, C_K);
  filter->pin(out.camera);
  out.anchor = filter->add_anchor(out.camera);
  out.slot = filter->add_point_of(out.camera, out.anchor, x_K, C_x);
  return out;
}

/// J C J^T with J by central differences of where the point is, and given K what it was before.
void test_a_point_of_a_known_camera_should_share_its_errors() {
  SeededRandom random(517);
  for (int trial = 0; trial < 20; ++trial) {
    TestFilter filter(true, BodyLayout::with_constant_velocity(), 60, 12);
    const Quat q_WK = exp_so3(random.normals<3>(1));
    const Vec3 p_WK = random.normals<3>(2), x_K = random.normals<3>(Scalar(0.3)) + Vec3(0, 0, 2);
    const Mat6 C_K = drawn_covariance(random);
    const Mat3 C_x = drawn_covariance(random).topLeftCorner<3, 3>();
    const KnownPoint known = add_known(filter, q_WK, p_WK, C_K, x_K, C_x);
    TEST_ASSERT_TRUE((filter->point(known.slot) - (p_WK + q_WK * x_K)).norm() < Scalar(1e-9));
    const Scalar h = Scalar(1e-5);
    Eigen::Matrix<Scalar, 3, 9> J;
    for (int k = 0; k < 9; ++k) {
      const auto at = [&](Scalar step) {
        Eigen::Matrix<Scalar, 9, 1> e = Eigen::Matrix<Scalar, 9, 1>::Zero();
        e(k) = step;
        return Vec3(p_WK + e.segment<3>(3) + exp_so3(Vec3(e.head<3>())) * (q_WK * (x_K + e.tail<3>())));
      };
      J.col(k) = (at(h) - at(-h)) / (2 * h);
    }
    Eigen::Matrix<Scalar, 9, 9> C = Eigen::Matrix<Scalar, 9, 9>::Zero();
    C.topLeftCorner<6, 6>() = C_K;
    C.bottomRightCorner<3, 3>() = C_x;
    const Mat3 expected = J * C * J.transpose();
    TEST_ASSERT_TRUE((filter->covariance3(known.slot) - expected).norm() < Scalar(1e-6) * expected.norm());
    const KnownPoint second = {known.camera, known.anchor,
                               filter->add_point_of(known.camera, known.anchor, 2 * x_K, C_x)};
    for (const int slot : {known.slot, second.slot}) {
      Vec3 given_K;
      Mat3 given;
      if (slot == second.slot) filter->convert_to_point(slot);
      TEST_ASSERT_TRUE(point_given(*filter, known.camera, slot, &given_K, &given));
      TEST_ASSERT_TRUE((given_K - (slot == known.slot ? x_K : Vec3(2 * x_K))).norm() < Scalar(1e-9));
      TEST_ASSERT_TRUE((given - C_x).norm() < Scalar(1e-6) * C_x.norm());
    }
  }
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_a_new_one_should_be_the_camera_with_its_full_correlation);
  RUN_TEST(test_a_prediction_should_leave_it_and_give_the_motion_the_noise);
  RUN_TEST(test_it_should_stay_while_it_is_pinned_and_go_without_a_trace);
  RUN_TEST(test_one_that_nothing_needs_should_go_with_the_next_removal);
  RUN_TEST(test_an_update_should_move_it_by_its_own_rows);
  RUN_TEST(test_a_point_of_a_known_camera_should_share_its_errors);
  RUN_TEST(test_a_full_filter_should_refuse_it_and_stay_as_it_is);
  return UNITY_END();
}
