#include "map/known_surface.h"

#include <cmath>

#include "map/tuning.h"

namespace pf {

KnownSurface known_surface(const Vec3& normal_W, const Vec3* points_W, int count, Scalar reach) {
  KnownSurface surface;
  if (!(normal_W.squaredNorm() > Scalar(0)) || count < 3) return surface;
  const Vec3 n = normal_W.normalized();
  const Vec3 side = std::abs(n.x()) < std::abs(n.y()) ? Vec3::UnitX() : Vec3::UnitY();
  surface.frame.R_WP.col(0) = (side - n * n.dot(side)).normalized();
  surface.frame.R_WP.col(1) = n.cross(surface.frame.R_WP.col(0));
  surface.frame.R_WP.col(2) = n;
  for (int i = 0; i < count; ++i) surface.frame.o_W += points_W[i] / static_cast<Scalar>(count);
  for (int i = 0; i < count; ++i) {
    const Vec2 uv = plane_coordinates(surface.frame, points_W[i]);
    extend_outline(&surface.outline, &uv, 1);
  }
  surface.reach = reach * std::sqrt(outline_area(surface.outline));
  return surface;
}

bool explains(const KnownSurface& surface, const Vec3& p_W, const Mat3& covariance, Scalar roughness, Scalar gate) {
  if (!(surface.reach > Scalar(0))) return false;
  if (!outline_contains(surface.outline, plane_coordinates(surface.frame, p_W), surface.reach)) return false;
  const Vec3 n = surface.frame.R_WP.col(2);
  const Scalar d = n.dot(p_W - surface.frame.o_W);
  return d * d < gate * (n.dot(covariance * n) + roughness * roughness);
}

bool may_be_plane(const KnownSurface& surface, const Vec3& n_W) {
  return std::abs(surface.frame.R_WP.col(2).dot(n_W)) > tuning::plane_search::kSameNormal;
}

}  // namespace pf
