#pragma once

#include "model/point_group.h"

namespace pf::model {

/// What (u, v) = t + M c depends on: t by I, phi and lambda by the columns of J_uv_rotation, c by M.
inline Vec2 group_to_plane(const PointGroup& group, const Vec2& c, Mat2* J_uv_rotation, Mat2* M) {
  *M = group.linear();
  const Vec2 d = *M * c;
  J_uv_rotation->col(0) = Vec2(-d.y(), d.x());
  J_uv_rotation->col(1) = d;
  return group.t + d;
}

/// A fixed point: coordinates c in its parent group, additive; considered (Schmidt), or without rows of its own.
/// value: c, and where it has no rows its covariance (xx, xy, yy)
struct GroupedPoint : Kind {
  static constexpr BlockKind kKind = BlockKind::kGroupedPoint;
  static constexpr KindInfo kInfo{2, 5, FeatureForm::kFixed, ScaleSource::kNone, true, false, false};
  static constexpr bool kHasPlace = true;

  static void place(const State& state, int slot, Place* out);
  static Vec3 point(const State& state, const Block& block);
  static void gauge(const State& state, const Block& block, GaugeRows* N);
};

}  // namespace pf::model
