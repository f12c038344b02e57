#include "vio_planes.h"

#include <algorithm>
#include <cmath>

namespace pfsim {
namespace {

using pf::sim::Vec3;

constexpr int kMost = 64;          // planes, surfaces
constexpr double kMatch = 0.1;     // [rad] a plane that is further off is no estimate of the surface
constexpr double kMatchOff = 0.1;  // likewise [m]
constexpr double kClass = 15 * 3.14159265358979 / 180;

}  // namespace

VioPlaneWatch::VioPlaneWatch(const pf_sim_t* scene, const pf::sim::Pose& first, const Vec3& gravity_W, double sigma_rad)
    : gravity_((first.R_WC.transposed() * gravity_W).unit()), sigma_rad_(sigma_rad) {
  double n[3], d = 0;
  for (int k = 0; scene != nullptr && k < kMost && pf_sim_surface(scene, k, n, &d) == PF_OK; ++k) {
    const Vec3 n_W{n[0], n[1], n[2]};
    const Vec3 n_C = first.R_WC.transposed() * n_W;
    const double along = std::fabs(n_C.dot(gravity_));
    const int orientation = along > std::cos(kClass)   ? PF_ORIENTATION_HORIZONTAL_UP
                            : along < std::sin(kClass) ? PF_ORIENTATION_VERTICAL
                                                       : PF_ORIENTATION_OTHER;
    surfaces_.push_back({n_C, d - n_W.dot(first.p_WC), orientation});
  }
}

/// Of the surface that a plane is; unknown where it is none.
int VioPlaneWatch::class_of(const pf_plane_t& plane) const {
  const Vec3 n{plane.normal_W[0], plane.normal_W[1], plane.normal_W[2]}, p{plane.p_WP[0], plane.p_WP[1], plane.p_WP[2]};
  int best = PF_ORIENTATION_UNKNOWN;
  double nearest = kMatchOff;
  for (const Surface& s : surfaces_) {
    const double off = std::fabs(s.n.dot(p) - s.d);
    if (n.cross(s.n).norm() > kMatch || off > nearest) continue;
    nearest = off;
    best = s.orientation != PF_ORIENTATION_HORIZONTAL_UP ? s.orientation
           : n.dot(gravity_) < 0                         ? PF_ORIENTATION_HORIZONTAL_UP
                                                         : PF_ORIENTATION_HORIZONTAL_DOWN;
  }
  return best;
}

void VioPlaneWatch::note(pf_slam_t* slam, bool gravity_known, bool last, VioPlanes* out) {
  pf_plane_t planes[kMost];
  std::size_t count = 0;
  if (surfaces_.empty() || pf_get_planes(slam, planes, kMost, &count) < PF_OK) return;
  for (std::size_t i = 0; i < std::min<std::size_t>(count, kMost); ++i) {
    const int is = planes[i].orientation, should = class_of(planes[i]);
    out->early += !gravity_known && is != PF_ORIENTATION_UNKNOWN;
    const bool wrong = is != PF_ORIENTATION_UNKNOWN && should != PF_ORIENTATION_UNKNOWN && is != should;
    out->ever_wrong += wrong;
    if (last && should != PF_ORIENTATION_UNKNOWN) {
      out->wrong += wrong;
      out->unknown += is == PF_ORIENTATION_UNKNOWN;
      out->right += is == should;
    }
    if (sigma_rad_ <= 0 || is != PF_ORIENTATION_VERTICAL || !told_.insert(planes[i].id).second) continue;
    const bool told = pf_set_plane_vertical(slam, planes[i].id, sigma_rad_) == PF_OK;
    out->told += told;
    out->refused += !told;
  }
}

}  // namespace pfsim
