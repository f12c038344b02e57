#include "filter/filter.h"
#include "filter/ray_on_plane.h"

/// A point that begins where its ray meets a plane, without being one of the plane.

namespace pf {

/// With q, where the ray meets the plane (RayOnPlane), seen from the anchor at o:
///
///   f = q + e d (q - c) . d,   e ~ (0, relative_sigma^2)         d the ray from the camera at c, of length 1
///   rho = 1 / |f - o|,  b = rho (f - o)                          at e = 0
///   (e_b, e_rho) = M (e_f - e_o),   M = (rho B^T; -rho^2 b^T)    B: the bearing's tangent basis
///   e_f = e_q + d (q - c) . d e
int Filter::add_before_plane(int anchor, int plane, const Vec3& ray_C, const Mat32& J_ray_z, const Mat2& noise_px,
                             Scalar relative_sigma, Scalar tau) {
  PF_ASSERT(state_.block[anchor].kind == BlockKind::kAnchor);
  RayOnPlane ray;
  if (!ray.meet(state_, plane, ray_C, tau)) return -1;
  const Vec3 o_W = state_.body.p_W;  // the anchor takes part in what the position does
  const int slot = take_slot(BlockKind::kInverseDepth);
  if (slot < 0) return -1;
  InverseDepth feature;
  feature.rho = Scalar(1) / (ray.q_W - o_W).norm();
  const Vec3 b = feature.rho * (ray.q_W - o_W);
  feature.q_b = turn_z_to(b);
  Mat3 M;
  M.topRows<2>() = feature.rho * feature.q_b.toRotationMatrix().leftCols<2>().transpose();
  M.row(2) = -feature.rho * feature.rho * b.transpose();

  RayOnPlane::RowsFor<3> J;
  ray.rows<3>(state_, plane, ray_C, J_ray_z, M, &J);
  const int columns = J.columns();
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) J.h[r * columns + Body::kPosition + c] -= M(r, c);
  const Mat32 J_z = ray.by_ray<3>(M) * J_ray_z;
  const Vec3 along = M * ray.d_W * (relative_sigma * (ray.q_W - ray.camera.p_W).dot(ray.d_W));
  const Mat3 noise = J_z * noise_px * J_z.transpose() + along * along.transpose();
  Scalar raw[9];
  put<3, 3>(raw, 3, 0, noise);
  blocks_.augment(slot, J, raw);
  state_.block[slot].set_inverse_depth(feature);
  state_.adopt(anchor, slot);
  return slot;
}

}  // namespace pf
