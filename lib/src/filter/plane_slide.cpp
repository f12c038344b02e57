#include <cmath>

#include "filter/camera_at.h"
#include "filter/filter.h"
#include "filter/tuning.h"
#include "geometry/small_cholesky.h"

/// A plane, or a point of one, is somewhere else than it was taken for. What pixels have told of it is its ray.

namespace pf {

using namespace tuning::plane_slide;

bool Filter::unfold_along(int slot, Scalar along, Scalar sigma_along) {
  const Vec3 p_W = point(slot), d_W = (p_W - camera_at(state_, Scalar(0)).p_W).normalized();
  if (!unfold(slot, Scalar(0))) return false;
  state_.block[slot].set_xyz(p_W + along * d_W);
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
  Scalar raw[9];
  blocks_.begin_spread();
  put<3, 3>(raw, 3, 0, B);
  blocks_.set_spread(Part::of(plane, 0, 3), raw);
  state_.for_each_planar(plane, [&](int slot) {
    const Vec3 ray = (point(slot) - c_W).normalized();
    const Scalar slant = n.dot(ray);
    if (!(std::abs(slant) > kMinSlant)) return;
    const Vec3 q = c_W + ray * ((d - n.dot(c_W)) / slant);
    if (!((q - c_W).dot(ray) > Scalar(0))) return;
    Mat13 J_x;
    plane_distance(frame, x, q, &J_x);
    const Mat23 rows = -(axes * ray / slant) * (J_x * B);
    put<2, 3>(raw, 3, 0, rows);
    blocks_.set_spread(Part::of(slot, 0, 2), raw);
    state_.block[slot].set_uv(plane_coordinates(frame, q));
  });
  blocks_.end_spread();
  block.set_xyz(x);
  const Scalar own[4] = {sigma_uv * sigma_uv, 0, 0, sigma_uv * sigma_uv};
  state_.for_each_planar(plane, [&](int slot) { blocks_.inflate(Part::of(slot, 0, 2), own); });
  return true;
}

}  // namespace pf
