#pragma once

#include "model/plane.h"

namespace pf::model {

/// Where a group of fixed points lies on its parent plane, see PointGroup. value: t, phi, lambda
struct Group : Kind {
  static constexpr BlockKind kKind = BlockKind::kPointGroup;
  static constexpr KindInfo kInfo{4, 4, FeatureForm::kNone, ScaleSource::kOwnRow, false, true, true};
  static constexpr bool kSharesGauge = true;

  /// Change of (u, v) = t by each direction, and rotation and scale of the coordinates about it.
  template <typename Rows>
  static void rows(const State& state, const Block& block, Rows* N) {
    PlanarRows plane;
    Plane::share(state, state.block[block.parent], &plane);
    const Vec2 t = block.group().t;
    for (int d = 0; d < gauge::kDirections; ++d) {
      for (int i = 0; i < 2; ++i) (*N)(i, d) = plane(i, d, t);
      (*N)(2, d) = (plane.by_u(1, d) - plane.by_v(0, d)) / 2;
      (*N)(3, d) = (plane.by_u(0, d) + plane.by_v(1, d)) / 2;
    }
  }
  static void gauge(const State& state, const Block& block, GaugeRows* N);
  static void add_gauge(const State& state, const Block& block, int first, const GaugeSum& sum);
  /// For coordinates in the group: the remaining shear.
  static void share(const State& state, const Block& block, PlanarRows* rows);
  /// e_lambda, less its change by a rotation of the world.
  static bool scale_row(const State& state, int slot, ScaleRow* row);
};

}  // namespace pf::model
