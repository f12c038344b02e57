#include <algorithm>
#include <cmath>

#include "api/context.h"
#include "api/copy.h"

namespace {

using pf::Scalar;
using pf::Vec2;
using pf::Vec3;

/// The class of which 95 % are: with gravity and the normal off by 1.96 of their sigma, it is still that one. For the two axes of a
/// horizontal plane 1.96 of their sum's root holds at least as many, whatever their shares.
int32_t orientation_of(const pf::TiltView& tilt) {
  if (!tilt.known) return PF_ORIENTATION_UNKNOWN;
  constexpr Scalar k15 = Scalar(0.2617994), k95 = Scalar(1.959964), kMinSine = Scalar(1e-3);
  const Scalar up = std::clamp(tilt.up, Scalar(-1), Scalar(1));
  const Scalar from_vertical = std::abs(std::asin(up)), from_horizontal = std::acos(std::abs(up));
  const Scalar sigma = tilt.sigma_up / std::max(std::sin(from_horizontal), kMinSine);  // of from_vertical
  if (from_horizontal + k95 * tilt.sigma_tilt < k15)
    return up > Scalar(0) ? PF_ORIENTATION_HORIZONTAL_UP : PF_ORIENTATION_HORIZONTAL_DOWN;
  if (from_vertical + k95 * sigma < k15) return PF_ORIENTATION_VERTICAL;
  const bool other = from_vertical - k95 * sigma > k15 && from_horizontal - k95 * sigma > k15;
  return other ? PF_ORIENTATION_OTHER : PF_ORIENTATION_UNKNOWN;
}

void describe(const pf::PlaneView& plane, std::uint32_t map_id, const pf::TiltView& tilt, pf_plane_t* out) {
  *out = pf_plane_t();
  out->id = plane.id;
  out->orientation = orientation_of(tilt);
  out->points = plane.points;
  out->members = plane.points - plane.trial;
  out->trial = plane.trial;
  out->fixed_points = plane.fixed_points;
  out->map_id = map_id;
  pf::copy(plane.normal_W, 3, out->normal_W);
  out->distance = static_cast<double>(plane.distance);
  pf::copy_matrix(plane.R_WP, out->R_WP);
  pf::copy(plane.p_WP, 3, out->p_WP);
  pf::copy_covariance(plane.covariance, out->covariance);
  out->is_wall = plane.known ? 1 : 0;
  out->rejected = plane.doubted ? 1 : 0;
  out->outline_count = plane.outline.count;
  for (int i = 0; i < plane.outline.count; ++i) pf::copy(plane.outline.uv[i], 2, out->outline_P[i]);
  out->area = static_cast<double>(pf::outline_area(plane.outline));
}

}  // namespace

pf_status_t pf_get_planes(const pf_slam_t* slam, pf_plane_t* planes, size_t capacity, size_t* count) {
  PF_REQUIRE_CONTEXT(slam);
  if (count == nullptr || (planes == nullptr && capacity > 0)) return PF_ERROR_NULL;
  *count = 0;
  const pf::View view = slam->session.view();
  for (int i = 0; i < view.map().planes.capacity(); ++i) {
    if (!view.map().planes.used(i)) continue;
    if (*count < capacity) {
      const pf::PlaneView plane = view.plane(i);
      describe(plane, view.tracking().map_id(), view.tilt(i, plane, slam->session.given_gravity_W()), &planes[*count]);
    }
    ++*count;
  }
  return *count > capacity ? PF_NOTE_TRUNCATED : PF_OK;
}

pf_status_t pf_find_plane(const pf_slam_t* slam, uint32_t id, uint32_t* current_id) {
  PF_REQUIRE_CONTEXT(slam);
  if (current_id == nullptr) return PF_ERROR_NULL;
  *current_id = slam->session.view().map().planes.find(id);
  return *current_id == 0 ? PF_NOTE_NOTHING : PF_OK;
}

pf_status_t pf_set_gravity(pf_slam_t* slam, const double gravity_W[3]) {
  PF_BEGIN_CHANGE(slam);
  if (gravity_W == nullptr) return PF_ERROR_NULL;
  if (!pf::finite(gravity_W, 3)) return PF_ERROR_NONFINITE;
  for (int i = 0; i < 3; ++i)
    if (!(std::fabs(gravity_W[i]) < 1e6)) return PF_ERROR_RANGE;
  slam->session.set_gravity(
      Vec3(static_cast<Scalar>(gravity_W[0]), static_cast<Scalar>(gravity_W[1]), static_cast<Scalar>(gravity_W[2])));
  return in_call.end(PF_OK);
}

pf_status_t pf_set_plane_vertical(pf_slam_t* slam, uint32_t plane, double sigma_rad) {
  PF_BEGIN_CHANGE(slam);
  if (!pf::finite(&sigma_rad, 1)) return PF_ERROR_NONFINITE;
  constexpr double kMinSigma = 1e-6, kMaxSigma = 0.5;
  if (sigma_rad != 0 && !(sigma_rad >= kMinSigma && sigma_rad <= kMaxSigma)) return PF_ERROR_RANGE;
  return in_call.end(slam->session.set_plane_vertical(plane, static_cast<Scalar>(sigma_rad)));
}

pf_status_t pf_hit_test(const pf_slam_t* slam, const double pixel[2], pf_hit_t* hit) {
  PF_REQUIRE_CONTEXT(slam);
  if (pixel == nullptr || hit == nullptr) return PF_ERROR_NULL;
  if (!pf::finite(pixel, 2)) return PF_ERROR_NONFINITE;
  const pf::View view = slam->session.view();
  if (!view.tracking().has_pose()) return PF_ERROR_STATE;
  pf::HitView found;
  if (!view.hit(Vec2(static_cast<Scalar>(pixel[0]), static_cast<Scalar>(pixel[1])), &found)) return PF_ERROR_RANGE;
  *hit = pf_hit_t();
  if (found.plane == 0) return PF_NOTE_NOTHING;
  hit->plane = found.plane;
  hit->range = static_cast<double>(found.range);
  pf::copy(found.p_W, 3, hit->p_W);
  pf::copy_covariance(found.covariance, hit->covariance);
  return PF_OK;
}
