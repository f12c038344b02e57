#include "model/planar_rows.h"

#include <cmath>

namespace pf::model {

void PlanarRows::of_plane(const PlaneFrame& frame, const Vec3& x) {
  const Vec3 normal = frame.R_WP.col(2);
  const Vec3 p_W = frame.o_W + x(2) * normal;
  const Vec3 p_u = frame.R_WP.col(0) + x(0) * normal, p_v = frame.R_WP.col(1) + x(1) * normal;
  by_u.setZero();
  by_v.setZero();
  for (int i = 0; i < 2; ++i) {
    const Vec3 axis = frame.R_WP.col(i);
    put(i, axis, p_W, &at);
    for (int k = 0; k < 3; ++k) at(i, k) = axis(k);
    put(i, axis, p_u, &by_u);
    put(i, axis, p_v, &by_v);
  }
}

void PlanarRows::of_group(const PlanarRows& plane, const PointGroup& group) {
  const Scalar cosine = std::cos(group.phi), sine = std::sin(group.phi);
  Mat2 R;
  R << cosine, -sine, sine, cosine;
  at.setZero();
  for (int d = 0; d < gauge::kDirections; ++d) {
    Mat2 M;
    M.col(0) = plane.by_u.col(d);
    M.col(1) = plane.by_v.col(d);
    const Scalar lambda = (M(0, 0) + M(1, 1)) / 2, phi = (M(1, 0) - M(0, 1)) / 2;
    M(0, 0) -= lambda;
    M(1, 1) -= lambda;
    M(1, 0) -= phi;
    M(0, 1) += phi;
    const Mat2 S = R.transpose() * (M * R);
    by_u.col(d) = S.col(0);
    by_v.col(d) = S.col(1);
  }
}

void PlanarRows::put(int i, const Vec3& axis, const Vec3& p_W, Rows* N) {
  const Vec3 moment = p_W.cross(axis);  // -axisᵀ [p]x
  for (int k = 0; k < 3; ++k) (*N)(i, 3 + k) = moment(k);
  (*N)(i, 6) = axis.dot(p_W);
}

}  // namespace pf::model
