#include "model/grouped_point.h"

namespace pf::model {

void GroupedPoint::place(const State& state, int slot, Place* out) {
  const Block& block = state.block[slot];
  const Block& group = state.block[block.parent];
  const Block& plane = state.block[group.parent];
  Mat2 J_rotation, M;
  const Vec2 uv = group_to_plane(group.group(), block.uv(), &J_rotation, &M);
  Mat3 J_x;
  Mat32 J_uv;
  out->o = plane_point(state.frame_of(plane), plane.xyz(), uv, &J_x, &J_uv);
  out->append<3>(group.parent, J_x);
  Eigen::Matrix<Scalar, 3, 4> J_group;
  J_group.leftCols<2>() = J_uv;
  J_group.rightCols<2>() = J_uv * J_rotation;
  out->append<4>(block.parent, J_group);
  out->J_own = J_uv * M;
  out->has_rows = block.size > 0;
  if (out->has_rows) out->append<2>(slot, out->J_own);
  out->plane = group.parent;
}

Vec3 GroupedPoint::point(const State& state, const Block& block) {
  const Block& parent = state.block[block.parent];
  const Block& plane = state.block[parent.parent];
  const PointGroup group = parent.group();
  const Vec2 uv = group.t + group.linear() * block.uv();
  return plane_point(state.frame_of(plane), plane.xyz(), uv);
}

void GroupedPoint::gauge(const State& state, const Block& block, GaugeRows* N) {
  PlanarRows rows;
  Group::share(state, state.block[block.parent], &rows);
  for (int i = 0; i < 2; ++i)
    for (int d = 0; d < gauge::kDirections; ++d) (*N)(i, d) = rows(i, d, block.uv());
}

}  // namespace pf::model
