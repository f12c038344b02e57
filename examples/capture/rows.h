#ifndef PLANEFOLD_CAPTURE_ROWS_H
#define PLANEFOLD_CAPTURE_ROWS_H

#include <planefold/planefold.h>

#include "maths.h"

namespace pf::capture {

/// Pixel of a point in C of the frame's own time, at the time of its row where the shutter rolls.
///
///   p_C(tau) = Exp(-w tau) (p_C - v_C tau),   tau = readout ((y + 1/2) / h - 1/2)        found in three turns
///
/// pose  of the camera, with its velocities
/// false where the camera has no such pixel
/// src   lib/docs/theory/rolling_shutter.md
bool project_row(const pf_camera_t& camera, const pf_pose_t& pose, const Vec3& p_C, double pixel[2]);

/// A point of the world in C.
Vec3 to_camera(const pf_pose_t& pose, const Vec3& p_W);

}  // namespace pf::capture

#endif
