#pragma once

#include "model/kind.h"

namespace pf::model {

/// A 3-D point: f_W, additive. value: x y z
struct Point : Kind {
  static constexpr BlockKind kKind = BlockKind::kPoint;
  static constexpr KindInfo kInfo{3, 3, FeatureForm::kPoint, ScaleSource::kDistance, false, false, false};
  static constexpr bool kHasPlace = true;

  static void place(const State& state, int slot, Place* out) {
    out->o = state.block[slot].xyz();
    out->append<3>(slot, Mat3::Identity());
  }
  static Vec3 point(const State&, const Block& block) { return block.xyz(); }
  static void gauge(const State&, const Block& block, GaugeRows* N) { put_place<3>(Mat3::Identity(), block.xyz(), N); }
  static void add_gauge(const State&, const Block& block, int first, const GaugeSum& sum) {
    sum.add_point(first, block.xyz());
  }
};

}  // namespace pf::model
