// Where each kind of feature is, d = w (o - c) + b: every Jacobian against central differences of the state itself.
#include "model/kinds.h"
#include "same.h"
#include "support/plane_scene.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

/// A scene with a feature of every kind: points, inverse depths, points of a plane, fixed points with rows and without.
struct EveryKind : PlaneScene {
  explicit EveryKind(SeededRandom& random) : PlaneScene(random, 0.01) {
    fold_all(drop());
    const int* wall = on_wall.data();
    TEST_ASSERT_TRUE(filter->fix(wall, 3, FixForm::kConsider, wall, 8));
    TEST_ASSERT_TRUE(filter->fix(wall + 3, 2, FixForm::kInflate, wall, 8));
    std::vector<Scalar> dx(static_cast<std::size_t>(filter.dim()));
    for (Scalar& d : dx) d = static_cast<Scalar>(0.05 * random.normal());
    filter.move(dx.data());
  }
};

Vec3 direction(const State& state, int slot, const Vec3& c) {
  Place at;
  TEST_ASSERT_TRUE(find_place(state, slot, &at));
  return at.w_column < 0 ? Vec3(at.o - c) : Vec3(at.w * (at.o - c) + at.b);
}

Vec3 point_of(const State& state, int slot) {
  Place at;
  TEST_ASSERT_TRUE(find_point(state, slot, &at));
  return at.o;
}

void test_directions_and_points_should_have_exact_jacobians_for_every_kind() {
  SeededRandom random(421);
  constexpr double step = 1e-6;
  int seen[8] = {};
  for (int trial = 0; trial < 5; ++trial) {
    EveryKind scene(random);
    const State& state = scene.filter->state();
    const int n = scene.filter.dim();
    const Vec3 c = random.normals<3>(1);
    for (int slot = 0; slot < state.slots; ++slot) {
      Place at, point;
      if (!find_place(state, slot, &at)) continue;
      TEST_ASSERT_TRUE(find_point(state, slot, &point));
      ++seen[static_cast<int>(state.block[slot].kind)];
      Dense J_d = Dense::Zero(3, n), J_p = Dense::Zero(3, n);
      int column = 0;
      for (int p = 0; p < at.parts; ++p)
        for (int i = 0; i < at.part[p].size; ++i, ++column) {
          Vec3 J = at.J_o.col(column);
          if (at.w_column >= 0) J = column == at.w_column ? Vec3(at.o - c) : Vec3(at.w * J + at.J_b.col(column));
          const int row = scene.filter->blocks().row(at.part[p]) + i;
          J_d.col(row) = J.cast<double>();
          J_p.col(row) = point.J_o.col(column).cast<double>();
        }
      for (int row = 0; row < n; ++row) {
        std::vector<Block> blocks(state.block, state.block + state.slots);
        Vec3 d[2], p[2];
        for (int side = 0; side < 2; ++side) {
          std::vector<Scalar> dx(static_cast<std::size_t>(n), Scalar(0));
          dx[static_cast<std::size_t>(row)] = static_cast<Scalar>(side == 0 ? step : -step);
          scene.filter.move(dx.data());
          d[side] = direction(state, slot, c);
          p[side] = point_of(state, slot);
          std::copy(blocks.begin(), blocks.end(), state.block);
        }
        TEST_ASSERT_TRUE(((d[0] - d[1]).cast<double>() / (2 * step) - J_d.col(row)).norm() < 1e-6);
        TEST_ASSERT_TRUE(((p[0] - p[1]).cast<double>() / (2 * step) - J_p.col(row)).norm() < 1e-6);
      }
    }
  }
  for (const BlockKind kind :
       {BlockKind::kPoint, BlockKind::kInverseDepth, BlockKind::kPlanePoint, BlockKind::kGroupedPoint})
    TEST_ASSERT_GREATER_THAN_INT(0, seen[static_cast<int>(kind)]);
}

void test_the_point_of_a_feature_should_be_where_its_direction_leads() {
  SeededRandom random(422);
  EveryKind scene(random);
  const State& state = scene.filter->state();
  for (int slot = 0; slot < state.slots; ++slot) {
    Place at;
    if (!find_point(state, slot, &at)) continue;
    TEST_ASSERT_TRUE((at.o - scene.filter->point(slot)).norm() < Scalar(1e-12));
    const Vec3 c = random.normals<3>(1);
    TEST_ASSERT_TRUE(direction(state, slot, c).cross(at.o - c).norm() < Scalar(1e-11));
  }
}

void test_an_inverse_depth_should_have_a_direction_and_no_point_when_it_is_not_positive() {
  SeededRandom random(423);
  TestFilter filter(true);
  const std::vector<int> slots = fill_map(random, filter, 0, 2);
  const State& state = filter->state();
  for (const double rho : {0.0, -0.1}) {
    state.block[slots[0]].value[4] = static_cast<Scalar>(rho);
    Place at;
    TEST_ASSERT_TRUE(find_place(state, slots[0], &at));
    TEST_ASSERT_FALSE(at.resolve());
    TEST_ASSERT_SAME(static_cast<Scalar>(rho), at.w);
  }
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_directions_and_points_should_have_exact_jacobians_for_every_kind);
  RUN_TEST(test_the_point_of_a_feature_should_be_where_its_direction_leads);
  RUN_TEST(test_an_inverse_depth_should_have_a_direction_and_no_point_when_it_is_not_positive);
  return UNITY_END();
}
