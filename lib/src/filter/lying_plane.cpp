#include "filter/lying_plane.h"

namespace pf {

LyingPlane lying_plane(const Filter& filter, int slot) {
  const State& state = filter.state();
  const Block& block = state.block[slot];
  const PlaneFrame& frame = state.frame_of(block);
  const Vec3 x = block.xyz();
  LyingPlane out;
  Vec3 normal_W;
  Mat3 J_n_x;
  plane_normal(frame, x, &normal_W, &out.distance, &J_n_x);
  out.frame = lying_frame(frame, x);
  Mat3 J_out_x;  // of (alpha, beta, delta) with respect to (a, b, h)
  J_out_x.row(0) = out.frame.R_WP.col(0).transpose() * J_n_x;
  J_out_x.row(1) = out.frame.R_WP.col(1).transpose() * J_n_x;
  J_out_x.row(2) << 0, 0, normal_W.dot(frame.R_WP.col(2));
  RowsOf<3, 3, 1> J;
  J.parts = 1;
  J.part[0] = Part::of(slot, 0, 3);
  put<3, 3>(J.h, 3, 0, J_out_x);
  out.covariance = filter.rounded_covariance_of<3>(J);
  return out;
}

Vec2 to_lying(const Filter& filter, int slot, const LyingPlane& plane, const Vec2& uv) {
  const State& state = filter.state();
  const Block& block = state.block[slot];
  const Vec3 d = plane_point(state.frame_of(block), block.xyz(), uv) - plane.frame.o_W;
  return Vec2(plane.frame.R_WP.col(0).dot(d), plane.frame.R_WP.col(1).dot(d));
}

}  // namespace pf
