#pragma once

#include "model/plane.h"

namespace pf::model {

/// A folded point: coordinates (u, v) in the frame of its parent plane, additive. value: u v        src Gee 2007 (9)
struct PlanePoint : Kind {
  static constexpr BlockKind kKind = BlockKind::kPlanePoint;
  static constexpr KindInfo kInfo{2, 2, FeatureForm::kFolded, ScaleSource::kDistance, true, false, false};
  static constexpr bool kHasPlace = true;

  static void place(const State& state, int slot, Place* out);
  static Vec3 point(const State& state, const Block& block);
  static void gauge(const State& state, const Block& block, GaugeRows* N);
};

}  // namespace pf::model
