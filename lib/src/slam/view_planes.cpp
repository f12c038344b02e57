#include "filter/camera_at.h"
#include "geometry/ray_plane.h"
#include "geometry/so3.h"
#include "slam/frame_loop.h"
#include "slam/view.h"

/// Planes of the view, and intersections of rays with them.

namespace pf {

PlaneView View::plane(int i) const {
  const State& state = filter().state();
  const Block& block = state.block[map_.planes[i].slot];
  const PlaneFrame& frame = state.frame_of(block);
  const Vec3 x = block.xyz();
  PlaneView out;
  out.id = map_.planes[i].id;
  Mat3 J_n_x;
  plane_normal(frame, x, &out.normal_W, &out.distance, &J_n_x);
  const Vec3 e1 = frame.R_WP.col(0);
  out.R_WP.col(0) = (e1 - out.normal_W * out.normal_W.dot(e1)).normalized();
  out.R_WP.col(1) = out.normal_W.cross(out.R_WP.col(0));
  out.R_WP.col(2) = out.normal_W;
  out.p_WP = frame.o_W + x(2) * frame.R_WP.col(2);
  Mat3 J_out_x;  // of (alpha, beta, delta) with respect to (a, b, h)
  J_out_x.row(0) = out.R_WP.col(0).transpose() * J_n_x;
  J_out_x.row(1) = out.R_WP.col(1).transpose() * J_n_x;
  J_out_x.row(2) << 0, 0, out.normal_W.dot(frame.R_WP.col(2));
  const int first = filter().first_row(map_.planes[i].slot);
  Mat3 P;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) P(r, c) = filter().covariance()(first + r, first + c);
  out.covariance = J_out_x * P * J_out_x.transpose();
  PlaneOutline outline;
  const PlanePoints points = outline_plane(filter(), map_, i, &outline);
  out.points = points.folded;
  out.fixed_points = points.fixed;
  out.outline = outline;
  for (int k = 0; k < outline.count; ++k) {
    const Vec3 d = plane_point(frame, x, outline.uv[k]) - out.p_WP;
    out.outline.uv[k] = Vec2(out.R_WP.col(0).dot(d), out.R_WP.col(1).dot(d));
  }
  return out;
}

bool View::hit(const Vec2& pixel, HitView* hit) const {
  const Camera& lens = filter().lens();
  Vec3 ray_C;
  Mat32 J_ray_pixel;
  if (!unproject(lens, pixel, &ray_C, &J_ray_pixel)) return false;
  const State& state = filter().state();
  const CameraAt camera = camera_at(state, Scalar(0));
  const Vec3 direction = camera.q_WC * ray_C;
  *hit = HitView();
  for (int i = 0; i < map_.planes.capacity(); ++i) {
    if (!map_.planes.used(i)) continue;
    const Block& block = state.block[map_.planes[i].slot];
    const PlaneFrame& frame = state.frame_of(block);
    Vec3 at;
    Mat3 J[3];  // by the rotation, the position, the plane
    Mat3 J_direction;
    if (!intersect_ray_plane(frame, block.xyz(), camera.p_W, direction, &at, &J[1], &J_direction, &J[2])) continue;
    const Scalar range = (at - camera.p_W).norm();
    PlaneOutline outline;
    outline_plane(filter(), map_, i, &outline);
    if (!outline_contains(outline, plane_coordinates(frame, at))) continue;
    if (hit->plane != 0 && range >= hit->range) continue;
    J[0] = -J_direction * hat(direction);
    const int first[3] = {Body::kTheta, Body::kPosition, filter().first_row(map_.planes[i].slot)};
    Mat3 C = Mat3::Zero();
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) {
        Mat3 P;
        for (int r = 0; r < 3; ++r)
          for (int c = 0; c < 3; ++c) P(r, c) = filter().covariance()(first[a] + r, first[b] + c);
        C += J[a] * P * J[b].transpose();
      }
    const Mat3 J_ray = J_direction * camera.q_WC.toRotationMatrix();
    const Eigen::Matrix<Scalar, 3, kLensParameters> J_lens =
        J_ray.lazyProduct(ray_lens_jacobian(lens, ray_C, J_ray_pixel));
    const int lens_rows = state.lens_rows.count, lens_first = state.layout.row(BodyPart::kLens);
    for (int k = 0; k < lens_rows; ++k) {
      const Vec3 J_k = J_lens.col(state.lens_rows.parameter[k]);
      Vec3 P_k = Vec3::Zero();  // of the hit with this parameter
      for (int l = 0; l < lens_rows; ++l)
        P_k += filter().covariance()(lens_first + k, lens_first + l) / 2 * J_lens.col(state.lens_rows.parameter[l]);
      for (int a = 0; a < 3; ++a)
        for (int r = 0; r < 3; ++r) P_k += filter().covariance()(lens_first + k, first[a] + r) * J[a].col(r);
      C += J_k * P_k.transpose() + P_k * J_k.transpose();
    }
    *hit = {map_.planes[i].id, range, at, C};
  }
  return true;
}

}  // namespace pf
