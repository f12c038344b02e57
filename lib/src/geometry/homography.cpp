#include "geometry/homography.h"

#include <cmath>
#include <limits>

namespace pf {
namespace {

/// Inverse by cofactors. False when the columns, of about equal length, are nearly in a plane.
bool invert(const Mat3& A, Mat3* out) {
  const Vec3 a = A.col(0), b = A.col(1), c = A.col(2);
  const Vec3 bc = b.cross(c);
  const Scalar det = a.dot(bc);
  const Scalar size = a.norm() * b.norm() * c.norm();
  if (!(std::abs(det) > 8 * std::numeric_limits<Scalar>::epsilon() * size)) return false;
  out->row(0) = bc.transpose() / det;
  out->row(1) = c.cross(a).transpose() / det;
  out->row(2) = a.cross(b).transpose() / det;
  return true;
}

}  // namespace

bool homography_from_4(const Vec3 from[4], const Vec3 to[4], Mat3* H) {
  Mat3 A, B, A_inverse, B_inverse;
  for (int i = 0; i < 3; ++i) {
    A.col(i) = from[i];
    B.col(i) = to[i];
  }
  if (!invert(A, &A_inverse) || !invert(B, &B_inverse)) return false;
  const Vec3 a = A_inverse * from[3], b = B_inverse * to[3];
  const Scalar floor = 8 * std::numeric_limits<Scalar>::epsilon();
  for (int i = 0; i < 3; ++i) {
    // A zero means that from[3] (or to[3]) is in line with two others; a change of sign, that a point changes side.
    if (!(std::abs(a(i)) > floor * a.norm()) || !(std::abs(b(i)) > floor * b.norm())) return false;
    if (!(a(i) * b(i) > 0)) return false;
    B.col(i) *= b(i) / a(i);
  }
  const Mat3 M = B * A_inverse;
  const Scalar norm = M.norm();
  if (!(norm > 0) || !std::isfinite(norm)) return false;
  *H = M / norm;
  return true;
}

}  // namespace pf
