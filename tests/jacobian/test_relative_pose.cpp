// The camera now in the frame of a camera before: its Jacobians, and those of the motion since a reference camera in the state.
#include "geometry/relative_pose.h"
#include "model/reference_camera.h"
#include "support/filter_scene.h"
#include "support/numeric_jacobian.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

/// Error (theta, p) of a pose against another, in the frame that both are in.
Vec6 difference_of(const RelativePose& pose, const RelativePose& from) {
  Vec6 e;
  e.head<3>() = log_so3(pose.q_KC * from.q_KC.conjugate());
  e.tail<3>() = pose.p_KC - from.p_KC;
  return e;
}

RelativePose relative(const Body& K, const Body& C) { return relative_pose(K.q_WC, K.p_W, C.q_WC, C.p_W); }

void test_a_relative_pose_should_have_exact_jacobians_by_both_cameras() {
  SeededRandom random(501);
  for (int trial = 0; trial < 20; ++trial) {
    const Body K = random_body(random), C = random_body(random);
    const RelativePose at = relative(K, C);
    const auto by_C = [&](const Vec6& e) { return difference_of(relative(K, moved(C, e)), at); };
    const auto by_K = [&](const Vec6& e) { return difference_of(relative(moved(K, e), C), at); };
    check_jacobian<6, 6>(at.J_C, by_C, "J_C", Scalar(0.1));
    check_jacobian<6, 6>(at.J_K, by_K, "J_K", Scalar(0.1));
  }
}

void test_a_point_should_lie_in_k_where_the_relative_pose_says() {
  SeededRandom random(502);
  for (int trial = 0; trial < 20; ++trial) {
    const Body K = random_body(random), C = random_body(random);
    const RelativePose at = relative(K, C);
    const Vec3 p_C = random.normals<3>(1), p_W = C.p_W + C.q_WC * p_C;
    TEST_ASSERT_TRUE((at.q_KC * p_C + at.p_KC - K.q_WC.conjugate() * (p_W - K.p_W)).norm() < Scalar(1e-12));
  }
}

/// The covariance of the motion is J P J^T with J by central differences of the state itself, whatever other blocks there are.
void test_the_motion_s_covariance_should_be_that_of_the_state_s_error() {
  SeededRandom random(503);
  constexpr double step = 1e-6;
  for (int trial = 0; trial < 5; ++trial) {
    TestFilter filter(true);
    fill_map(random, filter, 2, 2);
    const int camera = filter->add_reference_camera();
    filter->pin(camera);
    Body body = random_body(random);
    filter->set_mean(body);
    fill_map(random, filter, 1, 1);  // blocks behind it
    const int n = filter.dim();
    const Dense P = random_covariance(random, n, 0.1);
    filter.set_P(P);
    State& state = const_cast<State&>(filter->state());
    body = state.body;
    const Block block = state.block[camera];
    const auto now = [&] {
      const Block& b = state.block[camera];
      return relative_pose(model::ReferenceCamera::q_WC(b), model::ReferenceCamera::p_WC(b), state.body.q_WC,
                           state.body.p_W);
    };
    const RelativePose at = now();
    Dense J(6, n);
    for (int row = 0; row < n; ++row) {
      Vec6 side[2];
      for (int k = 0; k < 2; ++k) {
        std::vector<Block> blocks(state.block, state.block + state.slots);
        std::vector<Scalar> dx(static_cast<std::size_t>(n), Scalar(0));
        dx[static_cast<std::size_t>(row)] = static_cast<Scalar>(k == 0 ? step : -step);
        filter.move(dx.data());
        side[k] = difference_of(now(), at);
        std::copy(blocks.begin(), blocks.end(), state.block);
        state.body = body;
      }
      J.col(row) = ((side[0] - side[1]) / (2 * step)).cast<double>();
    }
    Quat q_KC;
    Vec3 p_KC;
    Mat6 covariance;
    filter->motion_since(camera, &q_KC, &p_KC, &covariance);
    TEST_ASSERT_TRUE((q_KC.coeffs() - at.q_KC.coeffs()).norm() < Scalar(1e-12));
    TEST_ASSERT_TRUE((p_KC - at.p_KC).norm() < Scalar(1e-12));
    const Dense expected = J * P * J.transpose();
    TEST_ASSERT_TRUE(difference(covariance.cast<double>(), expected) < 1e-6);
    TEST_ASSERT_TRUE((model::ReferenceCamera::p_WC(state.block[camera]) - model::ReferenceCamera::p_WC(block)).norm() ==
                     Scalar(0));
  }
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_a_relative_pose_should_have_exact_jacobians_by_both_cameras);
  RUN_TEST(test_a_point_should_lie_in_k_where_the_relative_pose_says);
  RUN_TEST(test_the_motion_s_covariance_should_be_that_of_the_state_s_error);
  return UNITY_END();
}
