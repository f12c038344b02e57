#include <cmath>

#include "api/context.h"
#include "api/copy.h"
#include "geometry/ray_plane.h"
#include "geometry/so3.h"

namespace {

using pf::Mat3;
using pf::Scalar;
using pf::Vec2;
using pf::Vec3;

/// The plane as it is now: normal, and a frame that has it as third axis.
struct PlaneNow {
  Mat3 R_WP;
  Vec3 p_WP;
  Vec3 normal_W;
  Scalar distance;
  Mat3 J_out_x;  ///< of (alpha, beta, delta) with respect to (a, b, h)
};

PlaneNow plane_now(const pf::State& state, const pf::Block& block) {
  const pf::PlaneFrame& frame = state.frame_of(block);
  const Vec3 x = block.xyz();
  PlaneNow now;
  Mat3 J_n_x;
  pf::plane_normal(frame, x, &now.normal_W, &now.distance, &J_n_x);
  const Vec3 e1 = frame.R_WP.col(0);
  now.R_WP.col(0) = (e1 - now.normal_W * now.normal_W.dot(e1)).normalized();
  now.R_WP.col(1) = now.normal_W.cross(now.R_WP.col(0));
  now.R_WP.col(2) = now.normal_W;
  now.p_WP = frame.o_W + x(2) * frame.R_WP.col(2);
  now.J_out_x.row(0) = now.R_WP.col(0).transpose() * J_n_x;
  now.J_out_x.row(1) = now.R_WP.col(1).transpose() * J_n_x;
  now.J_out_x.row(2) << 0, 0, now.normal_W.dot(frame.R_WP.col(2));
  return now;
}

int32_t orientation_of(const Vec3& normal, const double gravity_W[3]) {
  const Vec3 g(static_cast<Scalar>(gravity_W[0]), static_cast<Scalar>(gravity_W[1]), static_cast<Scalar>(gravity_W[2]));
  const Scalar length = g.norm();
  if (!(length > Scalar(0))) return PF_ORIENTATION_UNKNOWN;
  constexpr Scalar kCos15 = Scalar(0.9659258), kSin15 = Scalar(0.2588190);
  const Scalar up = -normal.dot(g) / length;
  if (up > kCos15) return PF_ORIENTATION_HORIZONTAL_UP;
  if (up < -kCos15) return PF_ORIENTATION_HORIZONTAL_DOWN;
  return std::abs(up) < kSin15 ? PF_ORIENTATION_VERTICAL : PF_ORIENTATION_OTHER;
}

void describe(const pf_slam_t* slam, int entry, pf_plane_t* out) {
  const pf::Filter& filter = slam->slam.filter();
  const pf::State& state = filter.state();
  const int slot = slam->slam.planes()[entry].slot;
  const pf::Block& block = state.block[slot];
  const PlaneNow now = plane_now(state, block);
  *out = pf_plane_t();
  out->id = slam->slam.planes()[entry].id;
  out->orientation = orientation_of(now.normal_W, slam->gravity_W);
  pf::PlaneOutline outline;
  const pf::PlanePoints points = slam->slam.outline(entry, &outline);
  out->points = points.folded;
  out->fixed_points = points.fixed;
  pf::copy(now.normal_W, 3, out->normal_W);
  out->distance = static_cast<double>(now.distance);
  pf::copy_matrix(now.R_WP, out->R_WP);
  pf::copy(now.p_WP, 3, out->p_WP);
  Mat3 P;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) P(i, j) = filter.covariance()(block.first + i, block.first + j);
  const Mat3 C = now.J_out_x * P * now.J_out_x.transpose();
  pf::copy_matrix(C, out->covariance);
  pf::PlaneOutline flat = outline;
  out->outline_count = outline.count;
  for (int i = 0; i < outline.count; ++i) {
    const Vec3 d = pf::plane_point(state.frame_of(block), block.xyz(), outline.uv[i]) - now.p_WP;
    flat.uv[i] = Vec2(now.R_WP.col(0).dot(d), now.R_WP.col(1).dot(d));
    pf::copy(flat.uv[i], 2, out->outline_P[i]);
  }
  out->area = static_cast<double>(pf::outline_area(flat));
}

}  // namespace

pf_status_t pf_get_planes(const pf_slam_t* slam, pf_plane_t* planes, size_t capacity, size_t* count) {
  PF_REQUIRE_CONTEXT(slam);
  if (count == nullptr || (planes == nullptr && capacity > 0)) return PF_ERROR_NULL;
  *count = 0;
  const pf::PlaneTable& table = slam->slam.planes();
  for (int i = 0; i < table.capacity(); ++i) {
    if (!table.used(i)) continue;
    if (*count < capacity) describe(slam, i, &planes[*count]);
    ++*count;
  }
  return *count > capacity ? PF_NOTE_TRUNCATED : PF_OK;
}

pf_status_t pf_find_plane(const pf_slam_t* slam, uint32_t id, uint32_t* current_id) {
  PF_REQUIRE_CONTEXT(slam);
  if (current_id == nullptr) return PF_ERROR_NULL;
  *current_id = slam->slam.planes().find(id);
  return *current_id == 0 ? PF_NOTE_NOTHING : PF_OK;
}

pf_status_t pf_set_gravity(pf_slam_t* slam, const double gravity_W[3]) {
  PF_REQUIRE_IDLE(slam);
  if (gravity_W == nullptr) return PF_ERROR_NULL;
  if (!pf::finite(gravity_W, 3)) return PF_ERROR_NONFINITE;
  for (int i = 0; i < 3; ++i)
    if (!(std::fabs(gravity_W[i]) < 1e6)) return PF_ERROR_RANGE;
  for (int i = 0; i < 3; ++i) slam->gravity_W[i] = gravity_W[i];
  return PF_OK;
}

pf_status_t pf_hit_test(const pf_slam_t* slam, const double pixel[2], pf_hit_t* hit) {
  PF_REQUIRE_CONTEXT(slam);
  if (pixel == nullptr || hit == nullptr) return PF_ERROR_NULL;
  if (!pf::finite(pixel, 2)) return PF_ERROR_NONFINITE;
  if (!slam->slam.has_pose()) return PF_ERROR_STATE;
  Vec3 ray_C;
  const Vec2 z(static_cast<Scalar>(pixel[0]), static_cast<Scalar>(pixel[1]));
  if (!pf::unproject(slam->settings.camera, z, &ray_C)) return PF_ERROR_RANGE;
  const pf::Filter& filter = slam->slam.filter();
  const pf::State& state = filter.state();
  const Vec3 direction = state.body.q_WC * ray_C;
  const pf::PlaneTable& table = slam->slam.planes();
  *hit = pf_hit_t();
  for (int i = 0; i < table.capacity(); ++i) {
    if (!table.used(i)) continue;
    const pf::Block& block = state.block[table[i].slot];
    const pf::PlaneFrame& frame = state.frame_of(block);
    Vec3 at;
    Mat3 J[3];  // by the turn, the position, the plane
    Mat3 J_direction;
    if (!pf::intersect_ray_plane(frame, block.xyz(), state.body.p_W, direction, &at, &J[1], &J_direction, &J[2]))
      continue;
    const Scalar range = (at - state.body.p_W).norm();
    pf::PlaneOutline outline;
    slam->slam.outline(i, &outline);
    if (!pf::outline_contains(outline, pf::plane_coordinates(frame, at))) continue;
    if (hit->plane != 0 && static_cast<double>(range) >= hit->range) continue;
    J[0] = -J_direction * pf::hat(direction);
    const int first[3] = {pf::Body::kTheta, pf::Body::kPosition, block.first};
    Mat3 C = Mat3::Zero();
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) {
        Mat3 P;
        for (int r = 0; r < 3; ++r)
          for (int c = 0; c < 3; ++c) P(r, c) = filter.covariance()(first[a] + r, first[b] + c);
        C += J[a] * P * J[b].transpose();
      }
    hit->plane = table[i].id;
    hit->range = static_cast<double>(range);
    pf::copy(at, 3, hit->p_W);
    pf::copy_matrix(C, hit->covariance);
  }
  return hit->plane == 0 ? PF_NOTE_NOTHING : PF_OK;
}
