#pragma once

#include "quaternion.h"

namespace pfsim::gee {

/// A pinhole with square pixels.
struct Camera {
  double width = 320, height = 240, focal = 1;  ///< [px]

  Vec2 centre() const { return {0.5 * (width - 1), 0.5 * (height - 1)}; }
  static Camera with_field_of_view(double degrees) {
    Camera camera;
    camera.focal = 0.5 * camera.width / std::tan(degrees * 3.14159265358979323846 / 360);
    return camera;
  }
  bool sees(const Vec2& z) const { return z.x() >= 0 && z.y() >= 0 && z.x() <= width - 1 && z.y() <= height - 1; }
};

struct PointJacobians {
  Mat<2, 7> J_z_v;  ///< with respect to v = (q, t)
  Mat<2, 3> J_z_m;  ///< with respect to the point in W
};

/// z = Pi(y), y = R(q)^T (m - t), y_z > 0.
///
/// v 7 (q, t), m point in W [m], z [px]; J null to skip; false when the point is not before the camera, outputs untouched
/// src    Gee 2007 (2)
inline bool project(const Camera& camera, const Vec7& v, const Vec3& m, Vec2* z, PointJacobians* J = nullptr) {
  const Vec4 q = v.head<4>();
  const Vec3 way = m - v.tail<3>();
  Mat<3, 4> J_y_q;
  const Vec3 y = rotate_back(q, way, J ? &J_y_q : nullptr);
  if (!(y.z() > 1e-3)) return false;
  *z = camera.focal * y.head<2>() / y.z() + camera.centre();
  if (J) {
    Mat<2, 3> J_z_y;
    J_z_y << 1, 0, -y.x() / y.z(), 0, 1, -y.y() / y.z();
    J_z_y *= camera.focal / y.z();
    J->J_z_m = J_z_y * rotation_of(q).transpose();
    J->J_z_v << J_z_y * J_y_q, -J->J_z_m;
  }
  return true;
}

}  // namespace pfsim::gee
