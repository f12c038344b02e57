#pragma once

#include "model/kind.h"
#include "model/planar_rows.h"

namespace pf::model {

/// (a, b, h) about its constant frame, additive, see geometry/plane.h. value: a b h
struct Plane : Kind {
  static constexpr BlockKind kKind = BlockKind::kPlane;
  static constexpr KindInfo kInfo{3, 3, FeatureForm::kNone, ScaleSource::kNone, false, false, true};
  static constexpr bool kSharesGauge = true;

  static void gauge(const State& state, const Block& block, GaugeRows* N) {
    N->topRows<3>() = plane_gauge(state.frame_of(block), block.xyz());
  }
  static void add_gauge(const State& state, const Block& block, int first, const GaugeSum& sum) {
    const GaugeRowsOf<3> N = plane_gauge(state.frame_of(block), block.xyz());
    sum.add(first, 3, N);
  }
  /// Of (u, v) on it.
  static void share(const State& state, const Block& block, PlanarRows* rows) {
    rows->of_plane(state.frame_of(block), block.xyz());
  }
};

}  // namespace pf::model
