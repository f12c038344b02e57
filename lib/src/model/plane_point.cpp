#include "model/plane_point.h"

namespace pf::model {

void PlanePoint::place(const State& state, int slot, Place* out) {
  const Block& block = state.block[slot];
  const Block& plane = state.block[block.parent];
  Mat3 J_x;
  Mat32 J_uv;
  out->o = plane_point(state.frame_of(plane), plane.xyz(), block.uv(), &J_x, &J_uv);
  out->append<3>(block.parent, J_x);
  out->append<2>(slot, J_uv);
  out->plane = block.parent;
}

Vec3 PlanePoint::point(const State& state, const Block& block) {
  const Block& plane = state.block[block.parent];
  return plane_point(state.frame_of(plane), plane.xyz(), block.uv());
}

void PlanePoint::gauge(const State& state, const Block& block, GaugeRows* N) {
  PlanarRows rows;
  Plane::share(state, state.block[block.parent], &rows);
  for (int i = 0; i < 2; ++i)
    for (int d = 0; d < gauge::kDirections; ++d) (*N)(i, d) = rows(i, d, block.uv());
}

}  // namespace pf::model
