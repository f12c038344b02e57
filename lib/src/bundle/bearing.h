#pragma once

#include "bundle/bundle.h"
#include "geometry/camera.h"

/// Measurements of a point by its bearing and inverse depth in a host pose, and their Jacobians.

namespace pf {

using Mat16 = Eigen::Matrix<Scalar, 1, 6>;

/// Pixel of a point, and its Jacobians (null to skip):
///
///   d = R_WH r + rho (p_H - p_C),   z = pi(R_WCᵀ d)
///   dz/dx_C = [J [d]x, -rho J],  dz/dx_H = [-J [R_WH r]x, rho J],  dz/drho = J (p_H - p_C),   J = dpi/dd_C R_WCᵀ
///
/// r      bearing in the host, R_WH r = ray_W        p_HC_W  p_H - p_C
/// x      (theta, p) of a pose, rotation on the world side
/// false  outside the camera's domain; outputs untouched
bool project_bearing(const Camera& camera, const Mat3& R_WC, const Vec3& ray_W, const Vec3& p_HC_W, Scalar rho,
                     Vec2* pixel, Mat26* J_z_C = nullptr, Mat26* J_z_H = nullptr, Vec2* J_z_rho = nullptr);

/// Distance of a point from a plane, and its Jacobians (null to skip):
///
///   e = n . p - d,   p = p_H + q,   q = R_WH r / rho
///   de/dx_H = [(q x n)ᵀ, nᵀ],  de/drho = -n . q / rho,  de/dx by plane_distance
///
/// x_H    (theta, p) of the host, rotation on the world side; q turns with it: n . (theta x q) = theta . (q x n)
Scalar bearing_plane_distance(const BundlePlane& plane, const Vec3& ray_W, const Vec3& p_H, Scalar rho,
                              Mat13* J_e_plane = nullptr, Mat16* J_e_H = nullptr, Scalar* J_e_rho = nullptr);

/// The same distance in units of a length that grows with the point's depth, and its Jacobians:
///
///   e' = e rho / rho_before,   de'/drho = (rho de/drho + e) / rho_before,   the others multiplied by rho / rho_before
///
/// A distance is the smaller the smaller the map is, and draws it together where little holds its scale; this one does not change where all
/// lengths are multiplied by the same factor, and is the distance where nothing has moved.
Scalar relative_plane_distance(const BundlePlane& plane, const Vec3& ray_W, const Vec3& p_H, Scalar rho,
                               Scalar rho_before, Mat13* J_e_plane = nullptr, Mat16* J_e_H = nullptr,
                               Scalar* J_e_rho = nullptr);

using RayByLens = Eigen::Matrix<Scalar, 3, kLensParameters>;

/// Derivative of a point's pixel by the lens, through which the pixel and the bearing in the host were seen both:
///
///   z = pi(d_C; c),  d_C = R_CWᵀ(R_WH r(c) + rho (p_H - p_C)):   dz/dc = dpi/dc + dpi/dd_C R_CW R_WH dr/dc
///
/// J_z_d    2x3, dpi/dd_C R_CW
/// J_ray_W  R_WH dr/dc by ray_lens_jacobian; zero where the bearing does not depend on the lens
inline LensJacobian bearing_lens_jacobian(const Camera& camera, const Vec3& d_C, const Mat23& J_z_d,
                                          const RayByLens& J_ray_W) {
  return lens_jacobian(camera, d_C) + J_z_d.lazyProduct(J_ray_W);
}

/// Huber's cost of a squared residual r2, in squared standard deviations, and the weight of its linearisation.
Scalar huber_cost(Scalar r2, Scalar huber, Scalar* weight);

}  // namespace pf
