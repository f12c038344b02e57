#include <cmath>

#include "filter/filter.h"
#include "filter/tuning.h"
#include "geometry/small_cholesky.h"
#include "model/camera_at.h"

/// Moves a plane, or a point of one, whose place was wrong. Points move along their rays, which pixels have measured.

namespace pf {

using namespace tuning::plane_slide;

bool Filter::unfold_along(int slot, Scalar along, Scalar sigma_along) {
  const Vec3 p_W = point(slot), d_W = (p_W - camera_at(state_, Scalar(0)).p_W).normalized();
  if (!unfold(slot, Scalar(0))) return false;
  begin_move();
  state_.block[slot].set_xyz(p_W + along * d_W);
  end_move();
  const Mat3 noise = sigma_along * sigma_along * d_W * d_W.transpose() + Mat3::Identity() * (kLateral * kLateral);
  Scalar raw[9];
  put<3, 3>(raw, 3, 0, noise);
  blocks_.inflate(Part::of(slot, 0, 3), raw);
  return true;
}

///   uv+ = axes q,   q = c + t d on the new plane,   dq/dx = -d (dr/dx) / (n . d),   r the distance from the plane
///
/// Points whose rays graze the plane stay.
bool Filter::slide_plane(int plane, const Vec3& x, const Mat3& Q, Scalar sigma_uv) {
  PF_ASSERT(group_of(plane) < 0);
  SmallCholesky<3> factored;
  if (!factored.factor(Q)) return false;
  const Mat3 B = factored.lower();
  Block& block = state_.block[plane];
  const PlaneFrame frame = state_.frame_of(block);
  const Mat23 axes = frame.R_WP.transpose().topRows<2>();
  const Vec3 c_W = camera_at(state_, Scalar(0)).p_W;
  Vec3 n;
  Scalar d;
  plane_normal(frame, x, &n, &d);
  const auto meets = [&](const Vec3& ray, Scalar slant) {
    return std::abs(slant) > kMinSlant && (d - n.dot(c_W)) / slant > Scalar(0) && ray.allFinite();
  };
  begin_move();
  state_.for_each_planar(plane, [&](int slot) {
    const Vec3 ray = (point(slot) - c_W).normalized();
    const Scalar slant = n.dot(ray);
    if (!meets(ray, slant)) return;
    state_.block[slot].set_uv(plane_coordinates(frame, Vec3(c_W + ray * ((d - n.dot(c_W)) / slant))));
  });
  block.set_xyz(x);
  end_move();
  Scalar raw[9];
  blocks_.begin_spread();
  put<3, 3>(raw, 3, 0, B);
  blocks_.set_spread(Part::of(plane, 0, 3), raw);
  state_.for_each_planar(plane, [&](int slot) {
    const Vec3 q = point(slot), ray = (q - c_W).normalized();
    const Scalar slant = n.dot(ray);
    if (!meets(ray, slant)) return;
    Mat13 J_x;
    plane_distance(frame, x, q, &J_x);
    const Mat23 rows = -(axes * ray / slant) * (J_x * B);
    put<2, 3>(raw, 3, 0, rows);
    blocks_.set_spread(Part::of(slot, 0, 2), raw);
  });
  blocks_.end_spread();
  const Scalar own[4] = {sigma_uv * sigma_uv, 0, 0, sigma_uv * sigma_uv};
  state_.for_each_planar(plane, [&](int slot) { blocks_.inflate(Part::of(slot, 0, 2), own); });
  return true;
}

}  // namespace pf
