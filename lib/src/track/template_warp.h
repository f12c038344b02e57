#pragma once

#include "geometry/camera.h"
#include "vision/appearance.h"
#include "vision/planar_template.h"

namespace pf {

/// Homography of a template's surface from the camera K of first sight to the current one C, on rays at depth 1:
///
///   H = R_CK + t (1 + slope . (ray - ray_0))^T,   t = rho_0 t_CK        p_C = H ray, up to scale
///
/// which is R + t n^T / d with the plane through the point, n_K ~ (slope, 1 - slope . ray_0).
/// src  Masoud 2015 (1); it maps from the reference to the current image, (2) and (5) of the paper need its inverse
struct TemplateWarp {
  Mat3 R_CK = Mat3::Identity();
  Vec3 t = Vec3::Zero();
  Vec2 ray_0 = Vec2::Zero();

  Mat3 homography(const Vec2& slope) const {
    return R_CK + t * Vec3(slope.x(), slope.y(), 1 - slope.dot(ray_0)).transpose();
  }
  /// Slopes of a plane that faces K.
  Vec2 facing() const { return ray_0 / (1 + ray_0.squaredNorm()); }
  /// Slopes of a plane with this normal, in K. False where K sees it from its edge.
  bool slope_of(const Vec3& normal_K, Vec2* slope) const {
    const Scalar along = normal_K.head<2>().dot(ray_0) + normal_K.z();
    *slope = normal_K.head<2>() / along;
    return slope->squaredNorm() < kMaxSlope * kMaxSlope;
  }
  /// Unit normal in K, towards the camera.
  Vec3 normal_of(const Vec2& slope) const { return -Vec3(slope.x(), slope.y(), 1 - slope.dot(ray_0)).normalized(); }

  static constexpr Scalar kMaxSlope = 10;
};

/// Centre of a template's middle pixel, in the image of first sight.
inline Vec2 template_centre(const PlanarTemplate& shape) {
  return Vec2(shape.left + shape.side / 2, shape.top + shape.side / 2);
}

/// False where the point is behind a camera, or the lens has no ray for the middle of the template.
inline bool make_template_warp(const Camera& camera, const PlanarTemplate& shape, const CameraView& first,
                               const Vec3& p_W, const Quat& q_WC, const Vec3& c_W, TemplateWarp* out) {
  Vec3 ray;
  if (!unproject(camera, template_centre(shape), &ray) || !(ray.z() > Scalar(0))) return false;
  const Mat3 R_WK = first.q_WC.toRotationMatrix(), R_CW = q_WC.toRotationMatrix().transpose();
  const Scalar depth = R_WK.col(2).dot(p_W - first.c_W);
  if (!(depth > Scalar(0))) return false;
  out->ray_0 = ray.head<2>() / ray.z();
  out->R_CK = R_CW.lazyProduct(R_WK);
  out->t = R_CW * (first.c_W - c_W) / depth;
  return true;
}

/// H with a translation of the current image in front of it, so that the middle of the template comes to a pixel.
/// False where the lens has no ray there.
inline bool anchored(const Camera& camera, const TemplateWarp& warp, const Mat3& H, const Vec2& pixel, Mat3* shift) {
  Vec3 ray;
  if (!unproject(camera, pixel, &ray) || !(ray.z() > Scalar(0))) return false;
  const Vec3 p = H * Vec3(warp.ray_0.x(), warp.ray_0.y(), 1);
  if (!(p.z() > Scalar(0))) return false;
  *shift = Mat3::Identity();
  shift->col(2).head<2>() = ray.head<2>() / ray.z() - p.head<2>() / p.z();
  return true;
}

}  // namespace pf
