#include "filter/vertical.h"

#include <algorithm>
#include <cmath>

#include "filter/filter.h"
#include "filter/tuning.h"

/// Planes that the caller states to be vertical (lib/docs/theory/inertial.md).

namespace pf {

using namespace tuning::vertical;

namespace {

constexpr int kRowColumns = 5;  ///< of the plane and of gravity

/// The row of z about these directions of normal and gravity: the first kRowColumns of `columns`.
void put_row(const State& state, int plane, const Mat3& J_n_x, const Vec3& n_W, const Vec3& g_W, int columns, Scalar* h,
             Part* part) {
  constexpr int kPlaneRows = 3;
  const Mat3 R_WG = state.body.q_WG.toRotationMatrix();
  Mat32 E;
  E << -R_WG.col(1), R_WG.col(0);
  part[0] = Part::of(plane, 0, kPlaneRows);
  part[1] = Part::body(state.layout.row(BodyPart::kGravity), 2);
  const Mat13 by_plane = g_W.transpose() * J_n_x;
  const Eigen::Matrix<Scalar, 1, 2> by_gravity = n_W.transpose() * E;
  put<1, 3>(h, columns, 0, by_plane);
  put<1, 2>(h, columns, kPlaneRows, by_gravity);
}

Vec3 normal_of(const State& state, int plane, Mat3* J_n_x) {
  const Block& block = state.block[plane];
  Vec3 n_W;
  Scalar d_W;
  plane_normal(state.frame_of(block), block.xyz(), &n_W, &d_W, J_n_x);
  return n_W;
}

}  // namespace

void predict_vertical(const State& state, int plane, VerticalMeasurement* out) {
  Mat3 J_n_x;
  const Vec3 n_W = normal_of(state, plane, &J_n_x), g_W = state.body.q_WG.toRotationMatrix().col(2);
  out->block = plane;
  out->predicted(0) = n_W.dot(g_W);
  out->measured(0) = Scalar(0);
  out->H.parts = 2;
  put_row(state, plane, J_n_x, n_W, g_W, kRowColumns, out->H.h, out->H.part);
}

bool take_vertical(Filter& filter, int plane, Scalar sigma, Scalar max_nis, VerticalRow* told) {
  VerticalMeasurement z;
  predict_vertical(filter.state(), plane, &z);
  z.set_noise(VerticalMeasurement::Matrix::Constant(sigma * sigma));
  const Scalar before = std::max(Scalar(0), filter.variance_of(z.H)), off = z.predicted(0);
  if (!(off * off <= max_nis * (before + sigma * sigma))) return false;
  Mat3 J_n_x;
  VerticalRow row;
  row.n_W = normal_of(filter.state(), plane, &J_n_x);
  row.g_W = filter.state().body.gravity_W();
  row.sigma = sigma;
  row.before = std::sqrt(before);
  const Measurement view = z.view();
  filter.begin_update(&view, 1);
  if (!filter.finish_update(&view, 1, nullptr, nullptr)) return false;
  *told = row;
  return true;
}

/// Of the row's information, 1 / (h P h^T), that of the statement is removed, 1 / sigma^2, and none that others contributed. The means of
/// tilt and gravity do not change, and what was known before stays known, whatever rounding and other linearisations leave of the
/// difference.
///
/// The row is the one that P has now. The update was made with h0, about n0 and g0, with h0 N(x0) = 0 for rotations phi of the world;
/// transport has since taken N(x0) to N(x), so h is h0 less its part along such a rotation, for which the body's rotation stands:
///
///   h = h0 - h0 N(x) e_theta,   h0 N(x) phi = (g x n0 + n x g0) . phi
///
/// P is tight along h alone. By as little as a row differs from it, it leans on heading, which is a hundred times less known.
void forget_vertical(Filter& filter, int plane, const VerticalRow& told) {
  constexpr int kColumns = kRowColumns + 3;
  const State& state = filter.state();
  Mat3 J_n_x;
  const Vec3 n_W = normal_of(state, plane, &J_n_x), g_W = state.body.gravity_W();
  const Vec3 n0_W =
      n_W.dot(told.n_W) < Scalar(0) ? Vec3(-told.n_W) : told.n_W;  // of a plane that was merged into this one
  RowsOf<1, kColumns, 3> row;
  row.parts = 3;
  put_row(state, plane, J_n_x, n0_W, told.g_W, kColumns, row.h, row.part);
  row.part[2] = Part::body(Body::kTheta, 3);
  Mat13 by_world = Mat13::Zero();  // without transport P holds h0
  if (filter.keeps_gauge()) by_world = -(g_W.cross(n0_W) + n_W.cross(told.g_W)).transpose();
  put<1, 3>(row.h, kColumns, kRowColumns, by_world);
  const Scalar now = std::max(Scalar(0), filter.variance_of(row)) + filter.blocks().rounding_of(row, 0);
  const Scalar known = Scalar(1) / (told.before * told.before);
  const Scalar left = std::max(known, Scalar(1) / (kMaxShrink * now) - Scalar(1) / (told.sigma * told.sigma));
  filter.forget_row(row, std::max(Scalar(0), Scalar(1) / left - now));
}

void allow_for_forgotten(const VerticalRow& gone, VerticalRow* other) {
  other->before = std::max(other->before, gone.before);
}

}  // namespace pf
