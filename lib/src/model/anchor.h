#pragma once

#include "model/kind.h"

namespace pf::model {

/// Where the camera was when inverse-depth points began: o_W, additive. value: x y z
struct Anchor : Kind {
  static constexpr BlockKind kKind = BlockKind::kAnchor;
  static constexpr KindInfo kInfo{3, 3, FeatureForm::kNone, ScaleSource::kNone, false, true, false};

  static void gauge(const State&, const Block& block, GaugeRows* N) { put_place<3>(Mat3::Identity(), block.xyz(), N); }
  static void add_gauge(const State&, const Block& block, int first, const GaugeSum& sum) {
    sum.add_point(first, block.xyz());
  }
};

}  // namespace pf::model
