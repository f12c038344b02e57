#include "filter/camera_at.h"
#include "filter/filter.h"
#include "filter/model/kinds.h"
#include "geometry/ray_plane.h"

/// A new point of a plane, where the ray of a pixel meets it.

namespace pf {

/// (u, v) = axes q, where the ray meets the plane at q, as a function of the camera, the plane, the lens and the pixel. Where the surface
/// is higher by r, the ray meets it at q + d r / (n . d).
int Filter::add_plane_point(int plane, const Vec3& ray_C, const Mat32& J_ray_z, const Mat2& noise_px, Scalar tau) {
  const PlaneFrame frame = state_.frame_of(state_.block[plane]);
  const Vec3 x = state_.block[plane].xyz();
  CameraAt camera = camera_at(state_, tau);
  const Mat3 R_WC = camera.q_WC.toRotationMatrix();
  const Vec3 d_W = R_WC * ray_C;
  Vec3 at, normal;
  Scalar distance;
  Mat3 J_c, J_d, J_x;
  if (!intersect_ray_plane(frame, x, camera.p_W, d_W, &at, &J_c, &J_d, &J_x)) return -1;
  const int slot = take_slot(BlockKind::kPlanePoint);
  if (slot < 0) return -1;
  const Mat23 axes = frame.R_WP.transpose().topRows<2>();
  Mat26 J_camera;
  J_camera.leftCols<3>() = -axes * (J_d * hat(d_W));
  J_camera.rightCols<3>() = axes * J_c;
  RowsOf<2, CameraAt::kMaxColumns + 3 + kLensParameters, 3> J;
  const int lens = state_.lens_rows.count, own = camera.columns(), columns = own + 3 + lens;
  for (int i = 0; i < 2 * columns; ++i) J.h[i] = Scalar(0);
  J.parts = lens > 0 ? 3 : 2;
  J.part[0] = camera.part();
  J.part[1] = Part::of(plane, 0, 3);
  camera.chain(J_camera, J.h, columns);
  put<2, 3>(J.h, columns, own, Mat23(axes * J_x));
  const Mat23 J_ray = axes * (J_d * R_WC);
  if (lens > 0) {
    J.part[2] = Part::body(state_.layout.row(BodyPart::kLens), lens);
    put_lens<2>(J_ray.lazyProduct(ray_lens_jacobian(state_.lens, ray_C, J_ray_z)), state_.lens_rows, own + 3, columns,
                J.h);
  }
  plane_normal(frame, x, &normal, &distance);
  const Mat2 J_z = J_ray * J_ray_z;
  const Vec2 rough = axes * d_W * (state_.roughness_of(state_.block[plane]) / normal.dot(d_W));
  const Mat2 noise = J_z * noise_px * J_z.transpose() + rough * rough.transpose();
  Scalar raw[4];
  put<2, 2>(raw, 2, 0, noise);
  blocks_.augment(slot, J, raw);
  state_.block[slot].set_uv(plane_coordinates(frame, at));
  state_.adopt(plane, slot);
  return slot;
}

}  // namespace pf
