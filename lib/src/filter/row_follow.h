#pragma once

#include "model/camera_at.h"

namespace pf {

/// A row's time depends on the pixel itself:
///
///   dz = H_row dx + z' k dz_y      k seconds per pixel, z' what the row's motion does to the pixel [px/s]
///
/// M of dz = M H_row dx. J_camera is by (theta, p) of the camera at the row.
Mat2 row_follow(const CameraAt& camera, const Mat26& J_camera, Scalar k);

}  // namespace pf
