// A plane that is told to be vertical: its row by the plane and by gravity's direction, against central differences; what it teaches, and
// what is forgotten of it.
#include "filter/vertical.h"
#include "support/filter_cases.h"
#include "support/inertial_cases.h"
#include "support/numeric_jacobian.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

using Vec5 = Eigen::Matrix<Scalar, 5, 1>;
using Vec1 = Eigen::Matrix<Scalar, 1, 1>;
using Mat15 = Eigen::Matrix<Scalar, 1, 5>;

void move(TestFilter& filter, int plane, const Vec5& e) {
  std::vector<Scalar> dx(static_cast<std::size_t>(filter.dim()), Scalar(0));
  for (int i = 0; i < 3; ++i) dx[static_cast<std::size_t>(filter.first(plane) + i)] = e(i);
  const int gravity = filter->state().layout.row(BodyPart::kGravity);
  for (int i = 0; i < 2; ++i) dx[static_cast<std::size_t>(gravity + i)] = e(3 + i);
  filter.move(dx.data());
}

void test_row_of_a_vertical_plane_should_be_exact() {
  SeededRandom random(321);
  for (int trial = 0; trial < 10; ++trial) {
    TestFilter filter(true, BodyLayout::with_inertial_unit());
    const Body body = random_inertial_body(random);
    filter->set_mean(body);
    const PlaneFrame frame = {random_turn(random, 1.5).toRotationMatrix(), random.normals<3>(2)};
    const int plane = filter->add_known_plane(frame, Mat3::Identity(), Scalar(0));
    move(filter, plane, random.normals<5>(0.3));
    const Vec3 x = filter->state().block[plane].xyz();
    const Quat q_WG = filter->state().body.q_WG;
    VerticalMeasurement z;
    const auto upright = [&](const Vec5& e) -> Vec1 {
      move(filter, plane, e);
      predict_vertical(filter->state(), plane, &z);
      const Vec1 value = z.predicted;
      Body back = filter->state().body;
      back.q_WG = q_WG;
      filter->set_mean(back);
      const_cast<State&>(filter->state()).block[plane].set_xyz(x);
      return value;
    };
    upright(Vec5::Zero());
    Mat15 J;
    for (int i = 0; i < 5; ++i) J(i) = z.H.h[i];
    check_jacobian<1, 5>(J, upright, "J of a vertical plane");
  }
}

/// A wall that stands 0.02 rad off gravity as it is known: both move by their shares of the variance, and forgetting gives it back.
void test_a_vertical_plane_should_turn_gravity_by_its_share_and_be_forgotten() {
  TestFilter filter(true, BodyLayout::with_inertial_unit());
  Body body;
  body.q_WG = exp_so3(Vec3(Scalar(0.02), 0, 0));  // z is up, and tilted about x: -y is where it leans
  filter->set_mean(body);
  constexpr Scalar kGravity = Scalar(0.01), kPlane = Scalar(0.01), kSigma = Scalar(0.001);
  PlaneFrame frame;
  frame.R_WP << 1, 0, 0, 0, 0, 1, 0, -1, 0;  // its normal is y
  const int plane = filter->add_known_plane(frame, Mat3::Identity() * kPlane * kPlane, Scalar(0));
  Dense P = filter.P();
  const int gravity = filter->state().layout.row(BodyPart::kGravity);
  for (int i = 0; i < filter->state().layout.rows(); ++i) P(i, i) = 1e-6;
  for (int i = 0; i < 2; ++i) P(gravity + i, gravity + i) = static_cast<double>(kGravity * kGravity);
  filter.set_P(P);
  VerticalMeasurement z;
  predict_vertical(filter->state(), plane, &z);
  TEST_ASSERT_TRUE(std::abs(z.predicted(0) + std::sin(Scalar(0.02))) < Scalar(1e-6));
  VerticalRow told;
  TEST_ASSERT_FALSE(take_vertical(*filter, plane, kSigma, Scalar(1), &told));  // two sigma off are above a gate of one
  TEST_ASSERT_FALSE(told.is_told());
  TEST_ASSERT_TRUE(take_vertical(*filter, plane, kSigma, Scalar(9), &told));
  TEST_ASSERT_TRUE(std::abs(told.before - Scalar(std::sqrt(2.0)) * kGravity) < Scalar(1e-4));
  predict_vertical(filter->state(), plane, &z);
  TEST_ASSERT_TRUE(std::abs(z.predicted(0)) < Scalar(2e-4));
  // Half of it each: 0.01 of gravity's tilt, which is about W's x.
  const Scalar tilt = std::asin(filter->state().body.q_WG.toRotationMatrix()(1, 2));
  TEST_ASSERT_TRUE(std::abs(std::abs(tilt) - Scalar(0.01)) < Scalar(3e-4));
  TEST_ASSERT_TRUE(std::abs(filter->variance_of(z.H) - kSigma * kSigma) < Scalar(0.1) * kSigma * kSigma);
  TEST_ASSERT_TRUE(filter->variance(gravity) < Scalar(0.6) * kGravity * kGravity);
  forget_vertical(*filter, plane, told);
  const Scalar of_row = filter->variance_of(z.H);
  TEST_ASSERT_TRUE(std::abs(of_row / (told.before * told.before) - 1) < Scalar(0.01));
  TEST_ASSERT_TRUE(std::abs(filter->variance(gravity) / (kGravity * kGravity) - 1) < Scalar(0.02));
}

/// Gravity as it points (z up), and walls whose normal is y, with the variances of their tilts.
struct Walls {
  static constexpr Scalar kGravity = Scalar(0.15), kPlane = Scalar(0.001);

  Walls() : filter(true, BodyLayout::with_inertial_unit()) {
    filter->set_mean(Body());
    PlaneFrame frame;
    frame.R_WP << 1, 0, 0, 0, 0, 1, 0, -1, 0;
    for (int& p : plane) p = filter->add_known_plane(frame, Mat3::Identity() * kPlane * kPlane, Scalar(0));
    P = filter.P();
    gravity = filter->state().layout.row(BodyPart::kGravity);
    for (int i = 0; i < filter->state().layout.rows(); ++i) P(i, i) = 1e-6;
    for (int i = 0; i < 2; ++i) P(gravity + i, gravity + i) = static_cast<double>(kGravity * kGravity);
  }
  /// Of gravity's tilt as the walls see it.
  Scalar variance() {
    VerticalMeasurement z;
    predict_vertical(filter->state(), plane[0], &z);
    return filter->variance_of(z.H);
  }

  TestFilter filter;
  int plane[2], gravity;
  Dense P;
};

/// One wall was told loosely, another then told gravity well: what the loose one is worth is little, and no more goes with it. (All that
/// the other had told went, 0.15 rad in place of 0.001.)
void test_forgetting_a_plane_should_leave_what_another_has_told() {
  Walls walls;
  walls.filter.set_P(walls.P);
  VerticalRow loose, tight;
  TEST_ASSERT_TRUE(take_vertical(*walls.filter, walls.plane[0], Scalar(0.3), Scalar(9), &loose));
  TEST_ASSERT_TRUE(take_vertical(*walls.filter, walls.plane[1], Scalar(0.001), Scalar(9), &tight));
  const Scalar both = walls.variance();
  TEST_ASSERT_TRUE(both < Scalar(4e-6));
  forget_vertical(*walls.filter, walls.plane[0], loose);
  TEST_ASSERT_TRUE(walls.variance() >= Scalar(0.999) * both);
  TEST_ASSERT_TRUE(walls.variance() < Scalar(1.1) * both);
  allow_for_forgotten(loose, &tight);
  forget_vertical(*walls.filter, walls.plane[1], tight);
  TEST_ASSERT_TRUE(std::abs(walls.variance() / (Walls::kGravity * Walls::kGravity) - 1) < Scalar(0.1));
}

/// Between telling and forgetting gravity moves by 0.002 rad about the walls' normal, with the transport of a rotation that is as
/// open as 0.17 rad. What is given back is tilt; heading, of which the row says next to nothing, stays as it was.
void forget_after_a_move(bool keep_gauge) {
  constexpr double kHeading = 0.17, kMoved = 0.002;
  Walls walls;
  walls.filter->keep_gauge(keep_gauge);
  Dense N = Dense::Zero(walls.P.rows(), 1);  // of a rotation about z: of the body alone, as long as gravity is along z
  N(2, 0) = 1;
  walls.filter.set_P(walls.P + kHeading * kHeading * N * N.transpose());
  VerticalRow told;
  TEST_ASSERT_TRUE(take_vertical(*walls.filter, walls.plane[0], Scalar(0.001), Scalar(9), &told));
  Body body = walls.filter->state().body;
  const Mat3 R0_WG = body.q_WG.toRotationMatrix();
  body.q_WG = exp_so3(Vec3(0, Scalar(kMoved), 0)) * body.q_WG;
  walls.filter->set_mean(body);
  // What the body's rotation shares with gravity moves by N(x+) - N(x-).
  Dense P = walls.filter.P(), T = Dense::Identity(P.rows(), P.rows());
  const Mat3 R_WG = body.q_WG.toRotationMatrix();
  for (int i = 0; i < 2 && keep_gauge; ++i)
    for (int j = 0; j < 3; ++j) T(walls.gravity + i, j) += static_cast<double>(R_WG(j, i) - R0_WG(j, i));
  walls.filter.set_P(T * P * T.transpose());
  forget_vertical(*walls.filter, walls.plane[0], told);
  TEST_ASSERT_TRUE(std::abs(walls.variance() / (Walls::kGravity * Walls::kGravity) - 1) < Scalar(0.1));
  TEST_ASSERT_TRUE(std::sqrt(walls.filter->variance(2)) < Scalar(1.01 * kHeading));
}

void test_forgetting_a_plane_should_not_open_heading() {
  forget_after_a_move(true);
  forget_after_a_move(false);
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_row_of_a_vertical_plane_should_be_exact);
  RUN_TEST(test_a_vertical_plane_should_turn_gravity_by_its_share_and_be_forgotten);
  RUN_TEST(test_forgetting_a_plane_should_leave_what_another_has_told);
  RUN_TEST(test_forgetting_a_plane_should_not_open_heading);
  return UNITY_END();
}
