#pragma once

#include "model/kind.h"

namespace pf::model {

/// What the noise of a reference image did to the four corners of a patch: errors of their pixels in it, the same in every frame, additive.
/// It depends on its reference camera. value: x y of each corner [px]
struct PatchCorners : Kind {
  static constexpr BlockKind kKind = BlockKind::kPatchCorners;
  static constexpr KindInfo kInfo{8, 8, FeatureForm::kNone, ScaleSource::kNone, false, false, false};

  static void gauge(const State&, const Block&, GaugeRows*) {}
  static void add_gauge(const State&, const Block&, int, const GaugeSum&) {}
};

}  // namespace pf::model
