#pragma once

// A filter with 3-D points on a wall and beside it, a plane through those on the wall, and a few inverse-depth points.

#include "support/filter_scene.h"

namespace pf {

struct PlaneScene {
  TestFilter filter;
  std::vector<int> on_wall, beside, far_off;
  std::vector<int> second_wall;  ///< nearly the same wall
  int plane = -1, other_plane = -1;
  PlaneFit fit;

  /// off: how far the wall's points lie from it [m].
  explicit PlaneScene(SeededRandom& random, double off, bool keep_gauge = true) : filter(keep_gauge) {
    far_off = fill_map(random, filter, 3, 4);
    const Body& body = filter->state().body;
    const Vec3 middle = body.p_W + body.q_WC * Vec3(Scalar(0.1), Scalar(-0.1), 3);
    const Mat3 R = (body.q_WC * random_turn(random, 0.3)).toRotationMatrix();
    const auto place = [&](double height) {
      const Vec3 q(static_cast<Scalar>(random.uniform(-0.8, 0.8)), static_cast<Scalar>(random.uniform(-0.6, 0.6)),
                   static_cast<Scalar>(height));
      return Vec3(middle + R * q);
    };
    const auto add = [&](const Vec3& p) { return filter->add_point(p, Mat3::Identity()); };
    for (int i = 0; i < 8; ++i) on_wall.push_back(add(place(off * random.normal())));
    for (int i = 0; i < 3; ++i) beside.push_back(add(place(0.5)));
    for (int i = 0; i < 5; ++i) second_wall.push_back(add(place(off * random.normal())));
    std::vector<Vec3> points;
    for (const int s : on_wall) points.push_back(filter->state().block[s].xyz());
    TEST_ASSERT_TRUE(fit_plane(points.data(), 8, body.p_W, &fit));
    spread(random, 0.05);
    plane = filter->add_plane(fit, on_wall.data(), 8, Scalar(0));
    TEST_ASSERT_TRUE(plane >= 0);
  }
  void spread(SeededRandom& random, double sigma) { filter.set_P(random_covariance(random, filter.dim(), sigma)); }

  static FoldRule drop() { return {Scalar(1e-3), Scalar(1e12), false}; }
  int fold_all(const FoldRule& rule) {
    unsigned char folded[Filter::kMaxFolded];
    return filter->fold(plane, on_wall.data(), static_cast<int>(on_wall.size()), rule, folded);
  }
  /// A second plane through the points of the second wall, with points folded into it.
  void add_second(const FoldRule& rule) {
    std::vector<Vec3> points;
    for (const int s : second_wall) points.push_back(filter->state().block[s].xyz());
    PlaneFit second;
    TEST_ASSERT_TRUE(fit_plane(points.data(), 5, filter->state().body.p_W, &second));
    other_plane = filter->add_plane(second, second_wall.data(), 5, Scalar(0));
    unsigned char folded[Filter::kMaxFolded];
    TEST_ASSERT_EQUAL_INT(5, filter->fold(other_plane, second_wall.data(), 5, rule, folded));
  }
};

/// What every row of the state says, in coordinates whose differences are errors: all blocks but bearings and the body's turn, which
/// no operation on planes changes, and which are left at zero.
inline Eigen::VectorXd coordinates(const TestFilter& filter) {
  const State& state = (*filter).state();
  const int rows = filter.dim();
  if (rows < Body::kPosition + 3) return {};  // never: for compilers that see an empty vector written to
  Eigen::VectorXd x = Eigen::VectorXd::Zero(rows);
  for (int i = 0; i < 3; ++i) x(Body::kPosition + i) = static_cast<double>(state.body.p_W[i]);
  for (int s = 0; s < state.slots; ++s) {
    const Block& block = state.block[s];
    if (block.kind == BlockKind::kNone || block.kind == BlockKind::kInverseDepth) continue;
    for (int i = 0; i < block.size; ++i) x(filter.first(s) + i) = static_cast<double>(block.value[i]);
  }
  return x;
}

}  // namespace pf
