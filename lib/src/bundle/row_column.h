#pragma once

#include "bundle/bundle.h"

namespace pf {

/// The row's part of the readout, -1/2 .. 1/2, of a pixel that is at y at the frame's time and moves along the rows by speed_y [px/s]: that
/// of the row in which it was read out.
///
///   s = ((y' + 1/2) / h - 1/2),   y' = y + readout s speed_y, in one iteration
inline Scalar readout_part(const Camera& camera, Scalar readout, Scalar y, Scalar speed_y) {
  const auto part = [&](Scalar row) { return (row + Scalar(0.5)) / static_cast<Scalar>(camera.height) - Scalar(0.5); };
  return part(y + readout * part(y) * speed_y);
}

/// A camera whose rows are read out one after the other.
struct ViewOfRows {
  const Mat3& R_CW;
  BundleRates rates;
  Scalar readout;  ///< by which its pixels are at the frame's time
};

/// Column of the readout in the Jacobian of a predicted pixel: how far one second more of readout takes it from where it is at the frame's
/// time [px/s].
///
///   u = s dz/dt,   dz/dt = J (d x R_WC w_C - rho v_W)
///
/// J  2x3, of the pixel by its direction d in W
/// y  of the pixel at the frame's time
inline Vec2 readout_column(const Camera& camera, const ViewOfRows& view, Scalar y, const Mat23& J, const Vec3& d,
                           Scalar rho) {
  const Vec3 w_W = view.R_CW.transpose().lazyProduct(view.rates.w_C);
  const Vec2 speed = J.lazyProduct(Vec3(d.cross(w_W) - rho * view.rates.v_W));
  return readout_part(camera, view.readout, y, speed.y()) * speed;
}

/// The same of a point that the camera itself sees at a pixel, at this inverse depth. Zero where the pixel has no ray.
inline Vec2 readout_column(const Camera& camera, const ViewOfRows& view, const Vec2& at, Scalar rho) {
  Vec3 ray_C;
  Vec2 z;
  Mat23 J;
  if (!unproject(camera, at, &ray_C) || !project(camera, ray_C, &z, &J)) return Vec2::Zero();
  const Vec3 d = view.R_CW.transpose().lazyProduct(ray_C);
  return readout_column(camera, view, at.y(), J.lazyProduct(view.R_CW), d, rho);
}

}  // namespace pf
