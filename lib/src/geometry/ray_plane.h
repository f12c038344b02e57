#pragma once

#include "geometry/plane.h"

namespace pf {

/// Where a ray meets a plane, and how that moves with the ray and the plane.
///
///   t = m_W · (foot_W - o_W) / (m_W · d_W),   hit_W = o_W + t d_W
///   m_W = R_WP (-a, -b, 1),   foot_W = frame.o_W + h R_WP (0, 0, 1)
///
///   J_hit_origin = I - d mᵀ / (m·d),   J_hit_direction = t J_hit_origin
///   J_hit_x      = d (e1·(hit - foot),  e2·(hit - foot),  1) / (m·d)            e1, e2: the frame's axes in W
///
/// origin_W, direction_W  o and d of the ray; d of any length but zero
/// J_hit_*                3x3 each, with respect to the origin, the direction and (a, b, h); null to skip
/// false when the plane is behind, or the ray meets it at more than 85 degrees from its normal; outputs untouched
bool intersect_ray_plane(const PlaneFrame& frame, const Vec3& x, const Vec3& origin_W, const Vec3& direction_W,
                         Vec3* hit_W, Mat3* J_hit_origin = nullptr, Mat3* J_hit_direction = nullptr,
                         Mat3* J_hit_x = nullptr);

}  // namespace pf
