// Spread of a pose against points: its linear map against displacements of the state, what the gauge does to it, and the limits.
#include "filter_slam/pose/usable_pose.h"
#include "support/filter_scene.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

struct MovedScene {
  TestFilter filter{false};
  std::vector<int> slots;

  explicit MovedScene(SeededRandom& random) { slots = fill_map(random, filter, 5, 6); }
  int count() const { return static_cast<int>(slots.size()); }

  /// (theta', p') of the error dx, from where points and camera really are after it.
  Vec6 relative_error(const Dense& dx) {
    const Body before = filter->state().body;
    std::vector<Vec3> f;
    for (const int slot : slots) f.push_back(filter->point(slot));
    TestVector step(dx);
    filter.move(step.data());
    const Body after = filter->state().body;
    Dense A = Dense::Zero(7, 7), b = Dense::Zero(7, 1);
    for (std::size_t i = 0; i < slots.size(); ++i) {
      const Vec3 e = filter->point(slots[i]) - f[i];
      const Vec3 d = f[i] - before.p_W;
      Dense G(3, 7);
      G << Dense::Identity(3, 3), -hat(d).cast<double>(), d.cast<double>();
      const double w = 1 / static_cast<double>((e - (after.p_W - before.p_W)).squaredNorm());
      A += w * G.transpose() * G;
      b += w * G.transpose() * e.cast<double>();
    }
    const Dense g = solved(A, b);
    Vec6 out;
    out << log_so3(after.q_WC * before.q_WC.conjugate()) - g.block(3, 0, 3, 1).cast<Scalar>(),
        after.p_W - before.p_W - g.block(0, 0, 3, 1).cast<Scalar>();
    for (Scalar& s : step.values) s = -s;
    filter.move(step.data());
    return out;
  }

  struct TestVector {
    explicit TestVector(const Dense& v) {
      for (int i = 0; i < v.rows(); ++i) values.push_back(static_cast<Scalar>(v(i, 0)));
    }
    const Scalar* data() const { return values.data(); }
    std::vector<Scalar> values;
  };
};

/// With P = dx dx^T the spread is the square of the relative error that dx makes.
void test_spread_should_be_that_of_displaced_states() {
  SeededRandom random(141);
  for (int trial = 0; trial < 20; ++trial) {
    MovedScene scene(random);
    Dense dx(scene.filter.dim(), 1);
    for (int i = 0; i < dx.rows(); ++i) dx(i, 0) = 1e-5 * random.normal();
    scene.filter.set_P(dx * dx.transpose());
    PoseSpread spread;
    TEST_ASSERT_TRUE(spread_against_points(*scene.filter, scene.slots.data(), scene.count(), &spread));
    const Vec6 e = scene.relative_error(dx);
    const Scalar rotation = e.head<3>().squaredNorm(), position = e.tail<3>().squaredNorm();
    TEST_ASSERT_TRUE(std::abs(spread.rotation - rotation) < Scalar(1e-3) * (rotation + Scalar(1e-15)));
    TEST_ASSERT_TRUE(std::abs(spread.position - position) < Scalar(1e-3) * (position + Scalar(1e-15)));
  }
}

void test_spread_should_not_see_what_moves_camera_and_points_together() {
  SeededRandom random(142);
  for (int trial = 0; trial < 20; ++trial) {
    MovedScene scene(random);
    const Dense N = scene.filter.gauge();
    Dense P = N * random_covariance(random, 7, 1) * N.transpose();
    for (int i = 0; i < P.rows(); ++i) P(i, i) += 1e-8;
    scene.filter.set_P(P);
    PoseSpread spread;
    TEST_ASSERT_TRUE(spread_against_points(*scene.filter, scene.slots.data(), scene.count(), &spread));
    TEST_ASSERT_TRUE(scene.filter->variance(Body::kTheta) + scene.filter->variance(Body::kPosition) > Scalar(0.01));
    TEST_ASSERT_TRUE(spread.rotation < Scalar(1e-5) && spread.position < Scalar(1e-5));
  }
}

/// The scene's points as features that were all inliers of this frame.
struct FrameOfScene {
  TestArena arena;
  Map map;
  Frame frame;

  explicit FrameOfScene(const MovedScene& scene) {
    TEST_ASSERT_TRUE(map.layout(*arena, 20, 2) && frame.layout(*arena, 20));
    map.init();
    frame.init();
    for (const int slot : scene.slots) {
      frame.add({map.features.add(slot), 0, MatchStatus::kInlier, BlockKind::kPoint, false, false, Vec2::Zero(),
                 Mat2::Zero(), Vec2::Zero(), Scalar(0)});
    }
  }
};

void test_pose_should_be_usable_below_20_degrees_and_half_the_depth_against_the_points() {
  SeededRandom random(143);
  MovedScene scene(random);
  const FrameOfScene f(scene);
  const auto usable = [&](double rotation, double position, double gauge) {
    const Dense N = scene.filter.gauge();
    Dense P = gauge * gauge * N * N.transpose();
    for (int i = 0; i < P.rows(); ++i) P(i, i) += 1e-8;
    for (int i = 0; i < 3; ++i) {
      P(i, i) += rotation * rotation / 3;
      P(3 + i, 3 + i) += position * position / 3;
    }
    scene.filter.set_P(P);
    Scalar depth = 0;
    const bool is = is_pose_usable(*scene.filter, f.map, f.frame, nullptr, 0, &depth);
    TEST_ASSERT_TRUE(depth > Scalar(0.9) && depth < Scalar(4.1));
    return is;
  };
  TEST_ASSERT_TRUE(usable(0.3, 0.3, 0));
  TEST_ASSERT_FALSE(usable(0.4, 0.3, 0));
  TEST_ASSERT_FALSE(usable(0.3, 3, 0));
  TEST_ASSERT_TRUE(usable(0.1, 0.1, 5));  // a drifted world is no reason to deny a pose
  TEST_ASSERT_FALSE(usable(0.4, 0.1, 5));
}

void test_pose_should_not_be_usable_without_inliers() {
  SeededRandom random(144);
  MovedScene scene(random);
  FrameOfScene f(scene);
  for (int i = 0; i < f.frame.match_count(); ++i) f.frame.match(i).status = MatchStatus::kOutlier;
  Scalar depth = 0;
  TEST_ASSERT_FALSE(is_pose_usable(*scene.filter, f.map, f.frame, nullptr, 0, &depth));
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_spread_should_be_that_of_displaced_states);
  RUN_TEST(test_spread_should_not_see_what_moves_camera_and_points_together);
  RUN_TEST(test_pose_should_be_usable_below_20_degrees_and_half_the_depth_against_the_points);
  RUN_TEST(test_pose_should_not_be_usable_without_inliers);
  return UNITY_END();
}
