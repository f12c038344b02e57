#pragma once

#include "base/eigen.h"

/// Pose of a camera from three points: the closed form, with all of its solutions.

namespace pf {

/// T_WC without a covariance.
struct CameraPose {
  Quat q_WC = Quat::Identity();
  Vec3 p_WC = Vec3::Zero();
};

constexpr int kMaxP3pSolutions = 4;

/// All poses from which three points lie on three rays:  s_i f_i = R_WCᵀ (X_i - p_WC),  s_i > 0.
///
///   s_i² + s_j² - 2 s_i s_j f_i·f_j = |X_i - X_j|²
///
/// are three equations in the distances s. With s_2 = u s_1 and s_3 = v s_1 they leave a polynomial of degree four in v
/// (Grunert 1841). Each of its roots is refined on the three equations.
///
/// points_W  X_i, the corners of a triangle     rays_C  f_i, of any length
/// poses     room for kMaxP3pSolutions
/// Returns how many there are, 0 for points on a line, coincident points or rays, and numbers that are not finite.
/// src       Haralick, Lee, Ottenberg and Nölle 1994, section 3.1 (Grunert's coefficients). Computed in double
int solve_p3p(const Vec3 points_W[3], const Vec3 rays_C[3], CameraPose* poses);

}  // namespace pf
