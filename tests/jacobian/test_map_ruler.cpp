// Where a filter that knows a body alone has the map of the window: pose and velocity in the map by errors of the state, against central
// differences; what a move of the map leaves as it is, and what its drift adds.
#include "keyframe_slam/inertial/map_ruler.h"
#include "support/filter_cases.h"
#include "support/inertial_cases.h"
#include "support/numeric_jacobian.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr int kColumns = 16;  ///< rotation, place, velocity, gyroscope's bias, place and length of the map
using Vec9 = Eigen::Matrix<Scalar, 9, 1>;
using Errors = Eigen::Matrix<Scalar, kColumns, 1>;

/// A body somewhere in a map that is 0.6 times as large as its lengths say, rotated and moved since the filter began.
struct Case {
  explicit Case(std::uint32_t seed) : filter(true, BodyLayout::with_inertial_unit()), ruler(*filter) {
    SeededRandom random(seed);
    filter->set_mean(random_inertial_body(random));
    TEST_ASSERT_TRUE(ruler.begin(filter->state().body.p_W, Scalar(1.7), Scalar(0.1)));
    Body body = filter->state().body;
    body.p_W += random.normals<3>(0.5);
    filter->set_mean(body);
    ruler.move({random_turn(random, 1), random.normals<3>(1), Scalar(0.6)}, true);
  }

  void move(const Errors& e) {
    MapRuler::MotionRows rows;
    ruler.set_rows(Mat3::Identity(), &rows);
    std::vector<Scalar> dx(static_cast<std::size_t>(filter.dim()), Scalar(0));
    for (int p = 0, c = 0; p < rows.parts; ++p) {
      const Part& part = rows.part[p];
      const int first = part.block == kBodyBlock ? part.offset : filter.first(part.block) + part.offset;
      for (int i = 0; i < part.size; ++i) dx[static_cast<std::size_t>(first + i)] = e(c++);
    }
    filter.move(dx.data());
  }

  TestFilter filter;
  MapRuler ruler;
};

void test_pose_and_velocity_in_the_map_should_have_exact_rows() {
  for (std::uint32_t seed = 1; seed <= 10; ++seed) {
    Case at(seed);
    MapRuler::MotionRows rows;
    at.ruler.set_rows(Mat3::Identity(), &rows);
    Eigen::Matrix<Scalar, 9, kColumns> J;
    for (int i = 0; i < 9; ++i)
      for (int j = 0; j < kColumns; ++j) J(i, j) = rows.h[i * kColumns + j];
    const Quat q = at.ruler.body().q_WC;
    const auto of_errors = [&](const Errors& e) -> Vec9 {
      Case moved(seed);
      moved.move(e);
      const Body body = moved.ruler.body();
      Vec9 out;
      out << log_so3(body.q_WC * q.conjugate()), body.p_W, body.v_W;
      return out;
    };
    check_jacobian<9, kColumns>(J, of_errors, "motion in the map", Scalar(0.5));
  }
}

void test_a_measured_pose_should_have_the_rows_of_the_pose() {
  Case at(3);
  const Body body = at.ruler.body();
  const Vec6 e = (Vec6() << 0.01, -0.02, 0.005, 0.03, 0.01, -0.02).finished();
  MapRuler::PoseMeasurement z;
  at.ruler.set_measurement(exp_so3(e.head<3>()) * body.q_WC, body.p_W + e.tail<3>(), Mat6::Identity(), &z);
  const Scalar tolerance = sizeof(Scalar) == 8 ? Scalar(1e-12) : Scalar(1e-5);
  TEST_ASSERT_TRUE((z.measured - z.predicted - e).norm() < tolerance);
  MapRuler::MotionRows rows;
  at.ruler.set_rows(Mat3::Zero(), &rows);
  for (int i = 0; i < 6 * kColumns; ++i) TEST_ASSERT_TRUE(z.H.h[i] == rows.h[i]);
}

/// Where the body is in the map goes with the map, and its speed with the map's lengths.
void test_a_move_of_the_map_should_take_the_body_along() {
  SeededRandom random(5);
  for (const bool keeps_lengths : {true, false}) {
    Case at(6);
    const Body before = at.ruler.body();
    const Similarity T = {random_turn(random, 1), random.normals<3>(1), Scalar(1.3)};
    at.ruler.move(T, keeps_lengths);
    const Body after = at.ruler.body();
    const Scalar tolerance = sizeof(Scalar) == 8 ? Scalar(1e-10) : Scalar(1e-4);
    TEST_ASSERT_TRUE(log_so3(after.q_WC * (T.q * before.q_WC).conjugate()).norm() < tolerance);
    if (keeps_lengths) TEST_ASSERT_TRUE((after.p_W - T.of(before.p_W)).norm() < tolerance);
    const Scalar faster = keeps_lengths ? T.s : Scalar(1);
    TEST_ASSERT_TRUE((after.v_W - faster * (T.q * before.v_W)).norm() < tolerance);
    const Vec3 gravity = T.q * before.gravity_W();
    TEST_ASSERT_TRUE((after.gravity_W() - gravity).norm() < tolerance);
  }
}

/// An adjustment moves the map about the body: the body goes where the newest keyframe goes, and gravity stays.
void test_an_adjustment_should_take_the_body_along() {
  SeededRandom random(7);
  Case at(8);
  const Body before = at.ruler.body();
  const CameraView from = {before.q_WC, before.p_W};
  const CameraView to = {random_turn(random, 0.1) * before.q_WC, before.p_W + random.normals<3>(0.1)};
  at.ruler.move_about(from, to);
  const Body after = at.ruler.body();
  const Scalar tolerance = sizeof(Scalar) == 8 ? Scalar(1e-10) : Scalar(1e-4);
  TEST_ASSERT_TRUE((after.p_W - to.c_W).norm() < tolerance);
  TEST_ASSERT_TRUE(log_so3(after.q_WC * to.q_WC.conjugate()).norm() < tolerance);
  TEST_ASSERT_TRUE((after.gravity_W() - before.gravity_W()).norm() < tolerance);
}

/// The map's size has changed about the body, so where the body is in the map is known as well as before; its speed in the map is not.
void test_drift_of_the_size_should_leave_the_body_where_it_is() {
  Case at(9);
  Dense P = at.filter.P();
  for (int i = 0; i < at.filter.dim(); ++i) P(i, i) += 1e-4;
  at.filter.set_P(P);
  MapRuler::MotionRows rows;
  at.ruler.set_rows(Mat3::Zero(), &rows);
  const Eigen::Matrix<Scalar, 12, 12> before = at.filter->covariance_of<12>(rows);
  const Scalar variance = at.ruler.scale_variance();
  at.ruler.drift(Mat6::Zero(), at.ruler.body().p_W, Scalar(0.05));
  const Eigen::Matrix<Scalar, 12, 12> after = at.filter->covariance_of<12>(rows);
  const Vec3 v = at.ruler.body().v_W;
  const Scalar grown = at.ruler.scale_variance() - variance;
  TEST_ASSERT_TRUE(std::abs(grown - Scalar(0.0025)) < Scalar(1e-5));
  const Mat3 added = Mat3((after - before).block<3, 3>(6, 6));
  const Scalar tolerance = sizeof(Scalar) == 8 ? Scalar(1e-12) : Scalar(1e-5);
  const Mat6 of_pose = (after - before).topLeftCorner<6, 6>();
  TEST_ASSERT_TRUE(of_pose.norm() < tolerance);
  TEST_ASSERT_TRUE((added - Scalar(0.0025) * v * v.transpose()).norm() < tolerance);
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_pose_and_velocity_in_the_map_should_have_exact_rows);
  RUN_TEST(test_a_measured_pose_should_have_the_rows_of_the_pose);
  RUN_TEST(test_a_move_of_the_map_should_take_the_body_along);
  RUN_TEST(test_an_adjustment_should_take_the_body_along);
  RUN_TEST(test_drift_of_the_size_should_leave_the_body_where_it_is);
  return UNITY_END();
}
