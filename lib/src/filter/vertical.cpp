#include "filter/vertical.h"

#include <algorithm>
#include <cmath>

#include "filter/filter.h"

/// Planes that somebody says are vertical (lib/docs/inertial.md).

namespace pf {

void predict_vertical(const State& state, int plane, VerticalMeasurement* out) {
  constexpr int kPlaneRows = 3, kColumns = 5;
  const Block& block = state.block[plane];
  Vec3 n_W;
  Scalar d_W;
  Mat3 J_n_x;
  plane_normal(state.frame_of(block), block.xyz(), &n_W, &d_W, &J_n_x);
  const Mat3 R_WG = state.body.q_WG.toRotationMatrix();
  Mat32 E;
  E << -R_WG.col(1), R_WG.col(0);
  out->block = plane;
  out->predicted(0) = n_W.dot(R_WG.col(2));
  out->measured(0) = Scalar(0);
  out->H.parts = 2;
  out->H.part[0] = Part::of(plane, 0, kPlaneRows);
  out->H.part[1] = Part::body(state.layout.row(BodyPart::kGravity), 2);
  const Mat13 by_plane = R_WG.col(2).transpose() * J_n_x;
  const Eigen::Matrix<Scalar, 1, 2> by_gravity = n_W.transpose() * E;
  put<1, 3>(out->H.h, kColumns, 0, by_plane);
  put<1, 2>(out->H.h, kColumns, kPlaneRows, by_gravity);
}

bool take_vertical(Filter& filter, int plane, Scalar sigma, Scalar max_nis, Scalar* sigma_before) {
  VerticalMeasurement z;
  predict_vertical(filter.state(), plane, &z);
  z.set_noise(VerticalMeasurement::Matrix::Constant(sigma * sigma));
  *sigma_before = std::sqrt(std::max(Scalar(0), filter.variance_of(z.H)));
  const Scalar variance = *sigma_before * *sigma_before + sigma * sigma, off = z.predicted(0);
  if (!(off * off <= max_nis * variance)) return false;
  const Measurement view = z.view();
  filter.begin_update(&view, 1);
  return filter.finish_update(&view, 1, nullptr, nullptr);
}

void forget_vertical(Filter& filter, int plane, Scalar sigma_before) {
  VerticalMeasurement z;
  predict_vertical(filter.state(), plane, &z);
  filter.forget_row(z.H, sigma_before * sigma_before);
}

}  // namespace pf
