#include "filter/ray_on_plane.h"

#include "model/kinds.h"

namespace pf {

bool RayOnPlane::meet(const State& state, int plane, const Vec3& ray_C, Scalar tau) {
  camera = camera_at(state, tau);
  R_WC = camera.q_WC.toRotationMatrix();
  d_W = R_WC * ray_C;
  const Block& block = state.block[plane];
  return intersect_ray_plane(state.frame_of(block), block.xyz(), camera.p_W, d_W, &q_W, &J_c, &J_d, &J_x);
}

}  // namespace pf
