#pragma once

#include "model/gauge.h"

namespace pf::model {

/// Gauge rows of a block with two coordinates in a plane or point group, affine in these:  N(c) = at + c_0 by_u + c_1 by_v.
struct PlanarRows {
  using Rows = GaugeRowsOf<2>;
  Rows at, by_u, by_v;

  /// (u, v) of a point p of the plane: the first rows of R_WPᵀ (I, -[p]x, p).
  void of_plane(const PlaneFrame& frame, const Vec3& x);
  /// Coordinates in a group, from the rows of its plane: the change of M by each direction, beside rotation and scale.
  void of_group(const PlanarRows& plane, const PointGroup& group);
  Scalar operator()(int i, int d, const Vec2& c) const { return at(i, d) + c.x() * by_u(i, d) + c.y() * by_v(i, d); }

 private:
  static void put(int i, const Vec3& axis, const Vec3& p_W, Rows* N);
};

}  // namespace pf::model
