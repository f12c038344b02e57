#include <cmath>

#include "api/context.h"
#include "api/copy.h"

namespace {

using pf::Scalar;
using pf::Vec2;
using pf::Vec3;

int32_t orientation_of(const Vec3& normal, const Vec3& g) {
  const Scalar length = g.norm();
  if (!(length > Scalar(0))) return PF_ORIENTATION_UNKNOWN;
  constexpr Scalar kCos15 = Scalar(0.9659258), kSin15 = Scalar(0.2588190);
  const Scalar up = -normal.dot(g) / length;
  if (up > kCos15) return PF_ORIENTATION_HORIZONTAL_UP;
  if (up < -kCos15) return PF_ORIENTATION_HORIZONTAL_DOWN;
  return std::abs(up) < kSin15 ? PF_ORIENTATION_VERTICAL : PF_ORIENTATION_OTHER;
}

void describe(const pf::PlaneView& plane, std::uint32_t map_id, const Vec3& gravity_W, pf_plane_t* out) {
  *out = pf_plane_t();
  out->id = plane.id;
  out->orientation = orientation_of(plane.normal_W, gravity_W);
  out->points = plane.points;
  out->fixed_points = plane.fixed_points;
  out->map_id = map_id;
  pf::copy(plane.normal_W, 3, out->normal_W);
  out->distance = static_cast<double>(plane.distance);
  pf::copy_matrix(plane.R_WP, out->R_WP);
  pf::copy(plane.p_WP, 3, out->p_WP);
  pf::copy_covariance(plane.covariance, out->covariance);
  out->known = plane.known ? 1 : 0;
  out->doubted = plane.doubted ? 1 : 0;
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
  for (int i = 0; i < view.plane_capacity(); ++i) {
    if (!view.has_plane(i)) continue;
    if (*count < capacity) describe(view.plane(i), view.map_id(), slam->session.gravity_W(), &planes[*count]);
    ++*count;
  }
  return *count > capacity ? PF_NOTE_TRUNCATED : PF_OK;
}

pf_status_t pf_find_plane(const pf_slam_t* slam, uint32_t id, uint32_t* current_id) {
  PF_REQUIRE_CONTEXT(slam);
  if (current_id == nullptr) return PF_ERROR_NULL;
  *current_id = slam->session.view().find_plane(id);
  return *current_id == 0 ? PF_NOTE_NOTHING : PF_OK;
}

pf_status_t pf_set_gravity(pf_slam_t* slam, const double gravity_W[3]) {
  PF_REQUIRE_IDLE(slam);
  if (gravity_W == nullptr) return PF_ERROR_NULL;
  if (!pf::finite(gravity_W, 3)) return PF_ERROR_NONFINITE;
  for (int i = 0; i < 3; ++i)
    if (!(std::fabs(gravity_W[i]) < 1e6)) return PF_ERROR_RANGE;
  slam->session.set_gravity(
      Vec3(static_cast<Scalar>(gravity_W[0]), static_cast<Scalar>(gravity_W[1]), static_cast<Scalar>(gravity_W[2])));
  return PF_OK;
}

pf_status_t pf_hit_test(const pf_slam_t* slam, const double pixel[2], pf_hit_t* hit) {
  PF_REQUIRE_CONTEXT(slam);
  if (pixel == nullptr || hit == nullptr) return PF_ERROR_NULL;
  if (!pf::finite(pixel, 2)) return PF_ERROR_NONFINITE;
  const pf::View view = slam->session.view();
  if (!view.has_pose()) return PF_ERROR_STATE;
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
