#pragma once

#include "model/camera_at.h"

namespace pf {

/// Pixel of a 3-D point, and its Jacobians.
///
///   p_C = R_WC^T (f_W - p_WC),   z = pi(p_C)                    p_C in front of the camera
///   dp_C: theta  R^T [f - p]x,   p  -R^T,   f  R^T
///
/// J_z_camera 2x6 of (theta, p), J_z_point 2x3. False when the point does not project; outputs are then undefined.
/// src Gee 2007 (2); rotation error on the world side.
bool observe_point(const Camera& lens, const CameraAt& camera, const Vec3& f_W, Vec2* z, Mat26* J_z_camera,
                   Mat23* J_z_point);

}  // namespace pf
