#pragma once

#include "geometry/camera.h"
#include "model/body.h"

/// Rows of a rolling shutter in the window (lib/docs/theory/rolling_shutter.md): row y is read out tau = row_time(y) after the frame's
/// time, when the camera is at
///
///   R_tau = R Exp(w tau),   p_tau = p + v tau
///
/// The map holds pixels as they would be at the frame's time; images are compared with pixels as they are.

namespace pf {

using Mat212 = Eigen::Matrix<Scalar, 2, BodyLayout::kVelocityRows>;

/// Whether the camera reads its rows out one after the other.
inline bool has_rows(const Camera& camera) { return camera.readout != Scalar(0); }

/// Pixel of the direction m - w p, seen tau seconds after the frame's time, and its Jacobian by (theta, p, v, w) of the body (null to
/// skip):
///
///   z = pi(R_tauᵀ (m - w p_tau)),   dz = J (theta + R J_l(w tau) tau e_w, e_p + tau e_v)
///
/// false  outside the camera's domain; outputs untouched
bool project_moving(const Camera& camera, const Body& body, Scalar tau, const Vec3& m, Scalar w, Vec2* pixel,
                    Mat212* J_pixel_body = nullptr);

/// The same at the time of the row where the pixel is, which is found in two rounds; the Jacobian is at that time.
bool project_row(const Camera& camera, const Body& body, const Vec3& m, Scalar w, Vec2* pixel,
                 Mat212* J_pixel_body = nullptr);

/// Where a pixel would be at the frame's time: less what the motion from then to its row does to the direction m - w p. The pixel itself
/// where the camera reads all rows out at once, or the direction is not seen.
Vec2 at_frame_time(const Camera& camera, const Body& body, const Vec3& m, Scalar w, const Vec2& measured);

}  // namespace pf
