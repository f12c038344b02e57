#include "filter/filter.h"
#include "filter/ray_on_plane.h"

/// A new point of a plane, where the ray of a pixel meets it.

namespace pf {

/// (u, v) = axes q, where the ray meets the plane at q, as a function of the camera, the plane, the lens and the pixel. Where the surface
/// is higher by r, the ray meets it at q + d r / (n . d).
int Filter::add_plane_point(int plane, const Vec3& ray_C, const Mat32& J_ray_z, const Mat2& noise_px, Scalar tau) {
  RayOnPlane ray;
  if (!ray.meet(state_, plane, ray_C, tau)) return -1;
  const int slot = take_slot(BlockKind::kPlanePoint);
  if (slot < 0) return -1;
  const PlaneFrame frame = state_.frame_of(state_.block[plane]);
  const Mat23 axes = frame.R_WP.transpose().topRows<2>();
  RayOnPlane::RowsFor<2> J;
  ray.rows<2>(state_, plane, ray_C, J_ray_z, axes, &J);
  Vec3 normal;
  Scalar distance;
  plane_normal(frame, state_.block[plane].xyz(), &normal, &distance);
  const Mat2 J_z = ray.by_ray<2>(axes) * J_ray_z;
  const Vec2 rough = axes * ray.d_W * (state_.roughness_of(state_.block[plane]) / normal.dot(ray.d_W));
  const Mat2 noise = J_z * noise_px * J_z.transpose() + rough * rough.transpose();
  Scalar raw[4];
  put<2, 2>(raw, 2, 0, noise);
  blocks_.augment(slot, J, raw);
  state_.block[slot].set_uv(plane_coordinates(frame, ray.q_W));
  state_.adopt(plane, slot);
  return slot;
}

}  // namespace pf
