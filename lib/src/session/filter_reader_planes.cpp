#include <algorithm>
#include <cmath>

#include "base/table_entries.h"
#include "filter/lying_plane.h"
#include "filter/vertical.h"
#include "filter_slam/filter_slam.h"
#include "geometry/ray_plane.h"
#include "geometry/so3.h"
#include "model/camera_at.h"
#include "session/filter_reader.h"

/// FilterReader: planes, and intersections of rays with them.

namespace pf {

PlaneView FilterReader::plane(int i) const {
  const int slot = map_.planes[i].slot;
  const LyingPlane plane = lying_plane(filter_, slot);
  PlaneView out;
  out.id = map_.planes[i].id;
  out.known = map_.planes[i].known;
  out.doubted = map_.planes[i].doubted;
  out.normal_W = plane.frame.R_WP.col(2);
  out.distance = plane.distance;
  out.R_WP = plane.frame.R_WP;
  out.p_WP = plane.frame.o_W;
  out.covariance = plane.covariance;
  PlaneOutline outline;
  const PlanePoints points = outline_plane(filter_, map_, i, &outline);
  out.points = points.folded;
  out.fixed_points = points.fixed;
  out.trial = points.on_trial;
  out.outline = outline;
  for (int k = 0; k < outline.count; ++k) out.outline.uv[k] = to_lying(filter_, slot, plane, outline.uv[k]);
  return out;
}

/// With n about s g, s = 1 or -1, and E of VerticalMeasurement: the tilt's error is e_n - s E d.
TiltView FilterReader::tilt(int i) const {
  TiltView out;
  if (!settings_.inertial || !slam_.tracking().has_pose() || !filter_.is_metric()) return out;
  const State& state = filter_.state();
  VerticalMeasurement z;
  predict_vertical(state, map_.planes[i].slot, &z);
  out.known = true;
  out.up = -z.predicted(0);
  out.sigma_up = std::sqrt(std::max(Scalar(0), filter_.rounded_covariance_of<1>(z.H)(0, 0)));
  constexpr int kColumns = 5;
  RowsOf<3, kColumns, 2> J;
  J.parts = z.H.parts;
  std::copy(z.H.part, z.H.part + z.H.parts, J.part);
  const Block& block = state.block[map_.planes[i].slot];
  Vec3 n_W;
  Scalar d_W;
  Mat3 J_n_x;
  plane_normal(state.frame_of(block), block.xyz(), &n_W, &d_W, &J_n_x);
  const Mat3 R_WG = state.body.q_WG.toRotationMatrix();
  const Scalar s = out.up < Scalar(0) ? Scalar(1) : Scalar(-1);
  Mat32 E;
  E << s * R_WG.col(1), -s * R_WG.col(0);
  put<3, 3>(J.h, kColumns, 0, J_n_x);
  put<3, 2>(J.h, kColumns, 3, E);
  out.sigma_tilt = std::sqrt(std::max(Scalar(0), filter_.rounded_covariance_of<3>(J).trace()));
  return out;
}

bool FilterReader::hit(const Vec2& pixel, HitView* hit) const {
  const Camera& lens = filter_.lens();
  Vec3 ray_C;
  Mat32 J_ray_pixel;
  if (!unproject(lens, pixel, &ray_C, &J_ray_pixel)) return false;
  const State& state = filter_.state();
  const CameraAt camera = camera_at(state, Scalar(0));
  const Vec3 direction = camera.q_WC * ray_C;
  *hit = HitView();
  for (const int i : used_entries(map_.planes)) {
    const Block& block = state.block[map_.planes[i].slot];
    const PlaneFrame& frame = state.frame_of(block);
    Vec3 at;
    Mat3 J_position, J_direction, J_plane;
    if (!intersect_ray_plane(frame, block.xyz(), camera.p_W, direction, &at, &J_position, &J_direction, &J_plane))
      continue;
    const Scalar range = (at - camera.p_W).norm();
    PlaneOutline outline;
    outline_plane(filter_, map_, i, &outline);
    if (!outline_contains(outline, plane_coordinates(frame, at))) continue;
    if (hit->plane != 0 && range >= hit->range) continue;
    RowsOf<3, 9 + kLensParameters, 3> J;  // by the camera's pose, the plane, the lens
    const int lens_rows = state.lens_rows.count, columns = 9 + lens_rows;
    J.parts = lens_rows > 0 ? 3 : 2;
    J.part[0] = Part::body(0, Body::kPoseDim);
    J.part[1] = Part::of(map_.planes[i].slot, 0, 3);
    put<3, 3>(J.h, columns, Body::kTheta, -J_direction * hat(direction));
    put<3, 3>(J.h, columns, Body::kPosition, J_position);
    put<3, 3>(J.h, columns, 6, J_plane);
    if (lens_rows > 0) {
      J.part[2] = Part::body(state.layout.row(BodyPart::kLens), lens_rows);
      const Mat3 J_ray = J_direction * camera.q_WC.toRotationMatrix();
      put_lens<3>(J_ray.lazyProduct(ray_lens_jacobian(lens, ray_C, J_ray_pixel)), state.lens_rows, 9, columns, J.h);
    }
    *hit = {map_.planes[i].id, range, at, filter_.rounded_covariance_of<3>(J)};
  }
  return true;
}

}  // namespace pf
