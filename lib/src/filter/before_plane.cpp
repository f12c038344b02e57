#include "filter/camera_at.h"
#include "filter/filter.h"
#include "filter/model/kinds.h"
#include "geometry/ray_plane.h"

/// A point that begins where its ray meets a plane, without being one of the plane.

namespace pf {

/// With h, where the ray meets the plane, seen from the anchor at o:
///
///   f = h + e d (h - c) . d,   e ~ (0, relative_sigma^2)         d the ray from the camera at c, of length 1
///   rho = 1 / |f - o|,  b = rho (f - o)                          at e = 0
///   (e_b, e_rho) = M (e_f - e_o),   M = (rho B^T; -rho^2 b^T)    B: the bearing's tangent basis
///   e_f = J_h_c e_c + J_h_d (-[d]x theta + R J_ray_z e_z + R J_ray_lens e_lens) + J_h_x e_x + d (h - c) . d e
int Filter::add_before_plane(int anchor, int plane, const Vec3& ray_C, const Mat32& J_ray_z, const Mat2& noise_px,
                             Scalar relative_sigma, Scalar tau) {
  PF_ASSERT(state_.block[anchor].kind == BlockKind::kAnchor);
  const CameraAt camera = camera_at(state_, tau);
  const Mat3 R_WC = camera.q_WC.toRotationMatrix();
  const Vec3 d_W = R_WC * ray_C, o_W = state_.body.p_W;  // the anchor takes part in what the position does
  const Block& surface = state_.block[plane];
  Vec3 hit_W;
  Mat3 J_c, J_d, J_x;
  if (!intersect_ray_plane(state_.frame_of(surface), surface.xyz(), camera.p_W, d_W, &hit_W, &J_c, &J_d, &J_x))
    return -1;
  const int slot = take_slot(BlockKind::kInverseDepth);
  if (slot < 0) return -1;
  InverseDepth feature;
  feature.rho = Scalar(1) / (hit_W - o_W).norm();
  const Vec3 b = feature.rho * (hit_W - o_W);
  feature.q_b = turn_z_to(b);
  Mat3 M;
  M.topRows<2>() = feature.rho * feature.q_b.toRotationMatrix().leftCols<2>().transpose();
  M.row(2) = -feature.rho * feature.rho * b.transpose();

  constexpr int kColumns = CameraAt::kMaxColumns + 3 + kLensParameters;
  RowsOf<3, kColumns, 3> J;
  const int lens = state_.lens_rows.count, own = camera.columns(), columns = own + 3 + lens;
  for (int i = 0; i < 3 * columns; ++i) J.h[i] = Scalar(0);
  J.parts = lens > 0 ? 3 : 2;
  J.part[0] = camera.part();
  J.part[1] = Part::of(plane, 0, 3);
  Eigen::Matrix<Scalar, 3, 6> J_camera;
  J_camera.leftCols<3>() = -M * (J_d * hat(d_W));
  J_camera.rightCols<3>() = M * J_c;
  camera.chain(J_camera, J.h, columns);
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) J.h[r * columns + Body::kPosition + c] -= M(r, c);
  put<3, 3>(J.h, columns, own, Mat3(M * J_x));
  const Mat3 J_ray = M * (J_d * R_WC);
  if (lens > 0) {
    J.part[2] = Part::body(state_.layout.row(BodyPart::kLens), lens);
    put_lens<3>(J_ray.lazyProduct(ray_lens_jacobian(state_.lens, ray_C, J_ray_z)), state_.lens_rows, own + 3, columns,
                J.h);
  }
  const Mat32 J_z = J_ray * J_ray_z;
  const Vec3 along = M * d_W * (relative_sigma * (hit_W - camera.p_W).dot(d_W));
  const Mat3 noise = J_z * noise_px * J_z.transpose() + along * along.transpose();
  Scalar raw[9];
  put<3, 3>(raw, 3, 0, noise);
  blocks_.augment(slot, J, raw);
  state_.block[slot].set_inverse_depth(feature);
  state_.adopt(anchor, slot);
  return slot;
}

}  // namespace pf
