#pragma once

#include "base/eigen.h"
#include "geometry/lens.h"

namespace pf {

/// A camera's pose from known points. Errors on the world side: R_true = Exp(θ) R_WC, p_true = p_WC + e.
struct PoseEstimate {
  Quat q_WC = Quat::Identity();
  Vec3 p_WC = Vec3::Zero();        ///< [m]
  Mat6 covariance = Mat6::Zero();  ///< of (θ, e) [rad, m]
  Scalar rms_px = 0;               ///< root of the mean square of the pixel coordinates' residuals [px]
};

constexpr int kPoseMaxPoints = 16;

/// Pixel of a world point seen from a pose, and its Jacobian with respect to (θ, e) about a pivot: θ turns the camera
/// about the pivot, p → pivot + Exp(θ)(p - pivot) + e. With the pivot at p it is the plain world-side error.
///
///   p_C = R_WCᵀ (p_W - p_WC),   J_pC = R_WCᵀ [ [p_W - pivot]x   -I ]
///
/// J_pixel_pose  2x6 (null to skip). False where project says so; outputs untouched.
bool project_from_pose(const Camera& camera, const Quat& q_WC, const Vec3& p_WC, const Vec3& p_W, const Vec3& pivot,
                       Vec2* pixel, Mat26* J_pixel_pose = nullptr);

/// Least squares of the reprojection from the pose in inout, which must see every point; damped Gauss-Newton about the
/// points' centroid. covariance = sigma_px² (JᵀJ)⁻¹ at the solution.
///
/// count     3 .. kPoseMaxPoints points, in a plane or not
/// sigma_px  of one pixel coordinate [px]
/// false when a point cannot be seen or the points do not fix a pose; inout untouched
bool refine_pose(const Camera& camera, const Vec3* points_W, const Vec2* pixels, int count, Scalar sigma_px,
                 PoseEstimate* inout);

/// What an error of the lens does to a pose that was fitted to these points:  J_pose_lens = -(JᵀJ)⁻¹ Jᵀ J_pixel_lens, J by the pose.
///
/// J_pose_lens  6 x rows.count, row-major
/// false when the points do not fix a pose; output untouched
bool pose_by_lens(const Camera& camera, const Vec3* points_W, int count, const PoseEstimate& pose, const LensRows& rows,
                  Scalar* J_pose_lens);

/// Corners of a rectangle in its own world: the centre is the origin, x right and y down as seen upright, z into the
/// wall; top left, top right, bottom right, bottom left.
void rectangle_points(Scalar width, Scalar height, Vec3 points_W[4]);

/// Pose of a camera that sees a rectangle, from the four corners alone, in the order of rectangle_points.
///
/// A distant plane has two solutions that fit almost equally, with the normals mirrored at the line of sight. Both are
/// refined; the better is returned. Where the other explains the corners nearly as well, its distance widens the
/// covariance by the share that its likelihood gives it: P = (1 - w) P₁ + w (P₂ + d dᵀ).
///
/// second_rms  of the other solution [px], the largest Scalar when there is none (may be null)
/// false when no pose puts the corners in front of the camera; outputs untouched
/// src  Schweighofer and Pinz 2006 (the two solutions)
bool rectangle_pose(const Camera& camera, Scalar width, Scalar height, const Vec2 corners[4], Scalar sigma_px,
                    PoseEstimate* best, Scalar* second_rms = nullptr);

}  // namespace pf
