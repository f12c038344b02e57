#include "geometry/two_view_plane.h"

#include "geometry/small_cholesky.h"
#include "geometry/so3.h"

namespace pf {

bool two_view_plane(const Vec3* ray_K, const Vec3* ray_C, const Mat3* R_CK, const Vec3* t_CK, int count, Vec3* m) {
  Mat3 A = Mat3::Zero();
  Vec3 b = Vec3::Zero();
  for (int k = 0; k < count; ++k) {
    const Mat3 across = hat(Vec3(ray_C[k].normalized()));
    const Vec3 turned = R_CK[k].lazyProduct(ray_K[k]), u = across.lazyProduct(t_CK[k]), v = across.lazyProduct(turned);
    A += u.squaredNorm() * ray_K[k] * ray_K[k].transpose();
    b -= u.dot(v) * ray_K[k];
  }
  SmallCholesky<3> cholesky;
  if (!cholesky.factor(A)) return false;
  const Vec3 solution = cholesky.solve<1>(b);
  for (int k = 0; k < count; ++k) {
    const Scalar inverse_depth = solution.dot(ray_K[k]);
    const Vec3 seen = R_CK[k].lazyProduct(ray_K[k]) + t_CK[k] * inverse_depth;
    if (!(inverse_depth > Scalar(0)) || !(seen.dot(ray_C[k]) > Scalar(0))) return false;
  }
  *m = solution;
  return true;
}

}  // namespace pf
