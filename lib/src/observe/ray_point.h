#pragma once

#include "geometry/ray_plane.h"
#include "model/camera_at.h"
#include "observe/point.h"

namespace pf {

/// Pixel of what a reference camera K saw on a plane, and its Jacobians. A pixel of K is a ray, which meets the plane in q; the camera now
/// projects q.
///
///   z = pi(R_CW (q - p_WC)),   q = p_WK + t d,   d = R_WK ray(z_K),   q on the plane
///   e_q = J_o e_p_K + J_d (-[d]x theta_K + R_WK J_ray_z e_z_K + R_WK J_ray_lens e_lens) + J_x e_x
///
/// Four of these are a homography: for a pinhole, pixels of K (R + t n^T / d) K^-1 with R, t = T_CK and n . p = d in K.
/// src  Servant 2008 (9)-(13), with the sign of n . p = d; no matrix, so every lens and every row time will do;
///      lib/docs/theory/homography.md
struct RayPoint {
  Vec2 z;
  Mat26 J_camera, J_reference;  ///< by (theta, p) of the camera now and of K
  Mat23 J_plane;                ///< by (a, b, h)
  Mat2 J_own;                   ///< by the pixel of K
  LensJacobian J_lens;          ///< at both ends

  /// False where the ray does not meet the plane or q does not project; nothing is valid then.
  bool observe(const Camera& lens, const CameraAt& camera, const Quat& q_WK, const Vec3& p_WK, const PlaneFrame& frame,
               const Vec3& x, const Vec2& z_K, bool by_lens) {
    Vec3 ray_K, q_W;
    Mat32 J_ray_z;
    Mat3 J_o, J_d, J_x;
    if (!unproject(lens, z_K, &ray_K, &J_ray_z)) return false;
    const Mat3 R_WK = q_WK.toRotationMatrix();
    const Vec3 d_W = R_WK.lazyProduct(ray_K);
    if (!intersect_ray_plane(frame, x, p_WK, d_W, &q_W, &J_o, &J_d, &J_x)) return false;
    Mat23 J_q;
    if (!observe_point(lens, camera, q_W, &z, &J_camera, &J_q)) return false;
    const Mat23 J_direction = J_q.lazyProduct(J_d), J_ray = J_direction.lazyProduct(R_WK);
    J_reference.leftCols<3>() = -J_direction.lazyProduct(hat(d_W));
    J_reference.rightCols<3>() = J_q.lazyProduct(J_o);
    J_plane = J_q.lazyProduct(J_x);
    J_own = J_ray.lazyProduct(J_ray_z);
    if (!by_lens) return true;
    J_lens = J_ray.lazyProduct(ray_lens_jacobian(lens, ray_K, J_ray_z));
    J_lens += lens_jacobian(lens, camera.q_WC.conjugate() * (q_W - camera.p_W));
    return true;
  }
};

}  // namespace pf
