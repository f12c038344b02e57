#include "plane_error.h"

#include "statistics.h"

namespace pfsim {

using pf::sim::Vec3;

double normalised_plane_error(const pf_plane_t& plane, const Vec3& normal, double distance) {
  const double* R = plane.R_WP;
  const Vec3 x{R[0], R[3], R[6]}, y{R[1], R[4], R[7]}, n{plane.normal_W[0], plane.normal_W[1], plane.normal_W[2]};
  const Vec3 p{plane.p_WP[0], plane.p_WP[1], plane.p_WP[2]};
  const Vec3 d = normal - n;
  const double error[3] = {x.dot(d), y.dot(d), distance - normal.dot(p)};
  return normalised_error(error, plane.covariance, 3, 3, 0);
}

}  // namespace pfsim
