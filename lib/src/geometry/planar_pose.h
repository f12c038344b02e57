#pragma once

#include "base/eigen.h"
#include "geometry/lens.h"
#include "geometry/pnp.h"

namespace pf {

constexpr int kPoseMaxPoints = 16;

/// Pixel of a world point seen from a pose, as in pnp.h.
inline bool project_from_pose(const Camera& camera, const Quat& q_WC, const Vec3& p_WC, const Vec3& p_W,
                              const Vec3& pivot, Vec2* pixel, Mat26* J_pixel_pose = nullptr) {
  return project_from_pose(camera, q_WC, p_WC, p_W, Scalar(1), pivot, pixel, J_pixel_pose);
}

/// Least squares of the reprojection from the pose in inout, which must see every point: refine_pnp with all points, to the end.
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
