#pragma once

#include "model/camera_at.h"

namespace pf {

/// Pixel of an inverse-depth point, and its Jacobians. Works at rho = 0 (a point at infinity) too.
///
///   d_W = rho (o_W - p_WC) + b,   z = pi(R_WC^T d_W)            in front of the camera
///   dd_W: theta [d]x (through R^T),   p -rho I,   o rho I,   e_b B,   e_rho o - p
///
/// J_z_camera 2x6 of (theta, p), J_z_anchor 2x3, J_z_feature 2x3 of (e_1, e_2, e_rho).
/// False when the point does not project; outputs are then undefined.
/// src Montiel, Civera, Davison 2006; the bearing is a unit vector with a tangent basis in place of two angles.
bool observe_inverse_depth(const Camera& lens, const CameraAt& camera, const Vec3& o_W, const InverseDepth& feature,
                           Vec2* z, Mat26* J_z_camera, Mat23* J_z_anchor, Mat23* J_z_feature);

/// 3-D point of an inverse-depth point, and its Jacobians.  f = o + b / rho,  rho > 0
///   J_f_o = I,   J_f_feature = [B / rho, -b / rho^2]
Vec3 inverse_depth_to_point(const Vec3& o_W, const InverseDepth& feature, Mat3* J_f_feature);

/// Place of an inverse-depth point for display, and its covariance, also where rho is not positive (then at the largest depth that
/// is shown). cov is 6x6 of (o, e_1, e_2, e_rho).
///
///   f = o + b / rho',   rho' = max(rho, kMinShownRho),   C = J cov J^T + (J_rho (rho' - rho))(J_rho (rho' - rho))^T
///
/// The second term is the second moment of the depth about the place that is shown: a far point is never reported as a known one.
Vec3 shown_place(const Vec3& o_W, const InverseDepth& feature, const Mat6& cov, Mat3* C);

/// How far from linear (Gaussian) the depth is: 4 sigma_d |cos a| / d1 (Civera, Davison, Montiel 2007), where sigma_d = sigma_rho /
/// rho^2, d1 the distance from the camera now at c_W, a the angle at the point between the first ray and the ray now.
/// Large where rho is not well above zero.
Scalar linearity_index(const Vec3& c_W, const Vec3& o_W, const InverseDepth& feature, Scalar sigma_rho);

/// State and Jacobians of a new inverse-depth point at a pixel whose unit ray in C is ray_C. The camera saw it from c = c_W beside
/// the anchor, which is not zero where rows are read out at other times than the frame's.
///
///   b = (R_WC r + rho c) / |..|;   e_b = B^T (-[R_WC r]x theta + R J_r_z e_z + rho e_c + c e_rho) / |..|;   rho free
///
/// J_feature_theta 2x3, J_feature_z 2x2, J_feature_c 2x3 (all for the bearing's two rows); J_feature_rho = J_feature_c c / rho.
InverseDepth begin_inverse_depth(const CameraAt& camera, const Vec3& ray_C, const Mat32& J_ray_z, Scalar rho,
                                 const Vec3& c_W, Mat23* J_feature_theta, Mat2* J_feature_z, Mat23* J_feature_c);

}  // namespace pf
