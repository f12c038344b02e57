#pragma once

#include "model/kind.h"

namespace pf::model {

/// A known plane that no measurement of the map has used yet. Its place does not depend on the map's gauge, so it has no gauge rows, and P
/// has no covariance between it and all else. value: as of a plane
struct PlaneApart : Kind {
  static constexpr BlockKind kKind = BlockKind::kPlaneApart;
  static constexpr KindInfo kInfo{3, 3, FeatureForm::kNone, ScaleSource::kNone, false, false, false};

  static void gauge(const State&, const Block&, GaugeRows* N) { N->topRows<3>().setZero(); }
  static void add_gauge(const State&, const Block&, int, const GaugeSum&) {}
};

}  // namespace pf::model
