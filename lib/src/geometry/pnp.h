#pragma once

#include <cstdint>

#include "geometry/camera.h"

/// Pose of a camera from any number of known points: refinement, and the search among wrong matches (lib/docs/theory/starting.md).

namespace pf {

/// A camera's pose from known points. Errors on the world side: R_true = Exp(θ) R_WC, p_true = p_WC + e.
struct PoseEstimate {
  Quat q_WC = Quat::Identity();
  Vec3 p_WC = Vec3::Zero();        ///< [m]
  Mat6 covariance = Mat6::Zero();  ///< of (θ, e) [rad, m]
  Scalar rms_px = 0;               ///< root of the mean square of the pixel coordinates' residuals [px]
};

/// A known point p_W = m / w and the pixel where it was seen. w = 0 is a direction, as of a point infinitely far away.
struct PnpPoint {
  Vec3 m;
  Scalar w;
  Vec2 pixel;
};

/// Pixel of a point seen from a pose, and its Jacobian with respect to (θ, e) about a pivot: θ rotates the camera about the
/// pivot, p → pivot + Exp(θ)(p - pivot) + e. With the pivot at p it is the plain world-side error.
///
///   p_C ~ R_WCᵀ (m - w p_WC),   J_pC = R_WCᵀ [ [m - w pivot]x   -w I ]
///
/// J_pixel_pose  2x6 (null to skip). False where project() is; outputs untouched.
bool project_from_pose(const Camera& camera, const Quat& q_WC, const Vec3& p_WC, const Vec3& m, Scalar w,
                       const Vec3& pivot, Vec2* pixel, Mat26* J_pixel_pose = nullptr);

struct PnpRefinement {
  Scalar sigma_px;  ///< of one pixel coordinate
  Scalar huber;     ///< residuals beyond this count linearly [standard deviations]; 0: none do
  int max_rounds;
};

/// Least squares of the reprojection from the pose in inout, which must see every point that is used; damped Gauss-Newton about the
/// points' centroid. covariance = sigma_px² (Jᵀ V J)⁻¹ at the solution, V the robust weights.
///
/// use     of each point, 0: it does not count; null: all count. At least three must
/// false   when a point cannot be seen or the points do not fix a pose; inout untouched
bool refine_pnp(const Camera& camera, const PnpPoint* points, int count, const unsigned char* use,
                const PnpRefinement& options, PoseEstimate* inout);

struct PnpSearch {
  Scalar max_residual_px;  ///< of an inlier
  int max_trials;          ///< sets of three points that are drawn
  int min_inliers;
  PnpRefinement refinement;
};

/// Finds the pose that most of the points support, though others are wrong (RANSAC). Hypotheses are the pose in inout and all
/// solutions of up to max_trials sets of three points; the one with the smallest sum of min(r², max_residual²) is refined on its
/// inliers, twice. Ends early when three right points would by now have been drawn with near certainty.
///
/// random   state of the generator, changed by each call; any seed
/// inliers  of each point, whether it is one
/// Returns how many inliers there are, 0 when they are less than min_inliers; inout is then untouched.
/// src      Fischler and Bolles 1981; the truncated sum is MSAC (Torr and Zisserman 2000)
int find_pose(const Camera& camera, const PnpPoint* points, int count, const PnpSearch& options, std::uint32_t* random,
              PoseEstimate* inout, unsigned char* inliers);

}  // namespace pf
