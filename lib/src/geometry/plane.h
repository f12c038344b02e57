#pragma once

#include "base/eigen.h"

namespace pf {

using Mat13 = Eigen::Matrix<Scalar, 1, 3>;
using Mat37 = Eigen::Matrix<Scalar, 3, 7>;

/// A constant frame near a plane: the origin o_W about in its middle, the third axis of R_WP about along its normal.
struct PlaneFrame {
  Mat3 R_WP = Mat3::Identity();
  Vec3 o_W = Vec3::Zero();
};

/// A plane is three numbers x = (a, b, h) about its frame, without singularities as long as a and b are small:
///
///   p_W = o_W + R_WP [u  v  h + a u + b v]ᵀ          point with the coordinates (u, v)
///   n_W = R_WP [-a  -b  1]ᵀ / sqrt(1 + a² + b²),     d_W = n_W · (o_W + R_WP [0 0 h]ᵀ),     n_W · p_W = d_W
///
/// src  Gee 2007, section 3.2, states seven parameters, origin and two basis vectors, of which six are independent and
///      three are seen by measurements; here the basis is constant and what is left are those three.

/// Point of the plane. J_p_x 3x3 with respect to (a, b, h), J_p_uv 3x2; null to skip.
Vec3 plane_point(const PlaneFrame& frame, const Vec3& x, const Vec2& uv, Mat3* J_p_x = nullptr,
                 Mat32* J_p_uv = nullptr);

/// Coordinates of a point's foot along the frame's third axis. J_uv_p 2x3 is constant: the first rows of R_WPᵀ.
Vec2 plane_coordinates(const PlaneFrame& frame, const Vec3& p_W);

/// Normal and distance, and their Jacobians (3x3, 1x3; null to skip).
void plane_normal(const PlaneFrame& frame, const Vec3& x, Vec3* n_W, Scalar* d_W, Mat3* J_n_x = nullptr,
                  Mat13* J_d_x = nullptr);

/// Signed distance of a point, n_W · p_W - d_W [m], and its Jacobians (1x3 each; null to skip).
Scalar plane_distance(const PlaneFrame& frame, const Vec3& x, const Vec3& p_W, Mat13* J_r_x = nullptr,
                      Mat13* J_r_p = nullptr);

/// How (a, b, h) change when the whole world is moved: columns for a translation, a rotation (world side) and the
/// logarithm of the scale, in this order. With A = R_WPᵀ [θ]x R_WP + s I,  c = R_WPᵀ (θ x o + t + s o),  m = (-a, -b, 1):
/// δa = mᵀ A (1, 0, a),  δb = mᵀ A (0, 1, b),  δh = mᵀ (A (0, 0, h) + c).
Mat37 plane_gauge(const PlaneFrame& frame, const Vec3& x);

/// The frame in which a plane lies: the origin at (u, v) = 0, and the axes turned as little as possible.
PlaneFrame lying_frame(const PlaneFrame& frame, const Vec3& x);

/// J_x_e 3x3 of a plane that lies in its frame (a = b = h = 0):  e = (α, β, δ),  n' = n + α e1 + β e2,  n' · (p - o) = δ.
///
///   (a, b, h) = (-α, -β, δ) to first order, for the frame's own origin o
Mat3 plane_error_jacobian();

/// The same plane about another frame, and J_new_old 3x3 (null to skip).
/// False when it is slanted by more than about 80 degrees to the new frame; outputs untouched.
bool reframe_plane(const PlaneFrame& from, const Vec3& x, const PlaneFrame& to, Vec3* x_new, Mat3* J_new_old = nullptr);

/// The plane that fits points best in the sense of squared distances: its frame, with a = b = h = 0, the axes along the
/// principal directions and the normal towards the viewer.
struct PlaneFit {
  PlaneFrame frame;
  Vec3 lambda = Vec3::Zero();  ///< eigenvalues of Σ (p - mean)(p - mean)ᵀ, ascending [m²]
  int count = 0;
};

/// False with fewer than three points, or when they are nearly on a line (the second eigenvalue is below 1e-6 of the third).
bool fit_plane(const Vec3* points_W, int count, const Vec3& viewer_W, PlaneFit* fit);

/// J_x_p 3x3: how the fit's (a, b, h) change with one of its points, the frame held. With r = p - mean and axes e1 e2 n:
///
///   δa = ((r·n) e1 + (r·e1) n)·δp / (λ1 - λ0),   δb = ((r·n) e2 + (r·e2) n)·δp / (λ2 - λ0),   δh = n·δp / count
///
/// Large where λ1 is near λ0: points near a line do not fix a plane.
Mat3 fit_plane_jacobian(const PlaneFit& fit, const Vec3& p_W);

}  // namespace pf
