#pragma once

#include "geometry/plane.h"
#include "map/plane_outline.h"

/// A flat surface that is known beside the planes of the map: the one that a target is on. What lies on it needs no other plane.

namespace pf {

struct KnownSurface {
  PlaneFrame frame;
  PlaneOutline outline;  ///< of the points that it is known by; no area: there is no surface
  Scalar reach = 0;      ///< beyond the outline [m]
};

/// The surface through these points, which lie on one plane with this normal; none where the normal is zero.
///
/// reach    beyond the outline, in square roots of its area
KnownSurface known_surface(const Vec3& normal_W, const Vec3* points_W, int count, Scalar reach);

/// Whether a point lies on the surface, as far as is known of it:
///
///   d = n . (p - o),   d^2 < gate (n^T Sigma n + roughness^2)
bool explains(const KnownSurface& surface, const Vec3& p_W, const Mat3& covariance, Scalar roughness, Scalar gate);

/// Whether a plane with this normal may be the surface itself.
bool may_be_plane(const KnownSurface& surface, const Vec3& n_W);

}  // namespace pf
