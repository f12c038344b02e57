#include "filter/state.h"

#include "geometry/so3.h"

namespace pf {
namespace {

Vec3 part(const Scalar* dx, int first) { return Vec3(dx[first], dx[first + 1], dx[first + 2]); }

/// Columns shift, turn, scale of something that is a place in W.
template <int Rows>
void put_place(const Eigen::Matrix<Scalar, Rows, 3>& axes, const Vec3& p_W, GaugeRows* N) {
  for (int i = 0; i < Rows; ++i) {
    const Vec3 axis = axes.row(i).transpose();
    const Vec3 turn = p_W.cross(axis);  // -axisᵀ [p]x
    for (int k = 0; k < 3; ++k) {
      (*N)(i, k) = axis(k);
      (*N)(i, 3 + k) = turn(k);
    }
    (*N)(i, 6) = axis.dot(p_W);
  }
}

/// (u, v) of a point p of the plane; rows 0 and 1.
void put_coordinates(const PlaneFrame& frame, const Vec3& x, const Vec2& uv, GaugeRows* N) {
  const Mat23 axes = frame.R_WP.transpose().topRows<2>();
  put_place<2>(axes, plane_point(frame, x, uv), N);
}

/// What each direction does to (u, v) at t, and M, by differences in the coordinates, in which it is affine.
void put_patch(const PlaneFrame& frame, const Vec3& x, const Patch& patch, bool inside, const Vec2& c, GaugeRows* N) {
  GaugeRows at, at_u, at_v;
  put_coordinates(frame, x, patch.t, &at);
  put_coordinates(frame, x, patch.t + Vec2(1, 0), &at_u);
  put_coordinates(frame, x, patch.t + Vec2(0, 1), &at_v);
  const Scalar cosine = std::cos(patch.phi), sine = std::sin(patch.phi);
  Mat2 turn;
  turn << cosine, -sine, sine, cosine;
  for (int d = 0; d < 7; ++d) {
    Mat2 M;
    M.col(0) = (at_u.col(d) - at.col(d)).head<2>();
    M.col(1) = (at_v.col(d) - at.col(d)).head<2>();
    const Scalar lambda = (M(0, 0) + M(1, 1)) / 2, phi = (M(1, 0) - M(0, 1)) / 2;
    if (!inside) {
      N->block<2, 1>(0, d) = at.col(d).head<2>();
      (*N)(2, d) = phi;
      (*N)(3, d) = lambda;
      continue;
    }
    M(0, 0) -= lambda;
    M(1, 1) -= lambda;
    M(1, 0) -= phi;
    M(0, 1) += phi;
    N->block<2, 1>(0, d) = turn.transpose() * (M * (turn * c));
  }
}

}  // namespace

void apply_error(State& state, const Scalar* dx) {
  Body& body = state.body;
  body.q_WC = exp_so3(part(dx, Body::kTheta)) * body.q_WC;
  body.q_WC.normalize();
  body.p_W += part(dx, Body::kPosition);
  if (state.body_dim > Body::kPoseDim) {
    body.v_W += part(dx, Body::kVelocity);
    body.w_C += part(dx, Body::kRate);
  }
  for (int s = 0; s < state.slots; ++s) {
    Block& block = state.block[s];
    switch (block.kind) {
      case BlockKind::kNone:
        break;
      case BlockKind::kInverseDepth: {
        InverseDepth d = block.inverse_depth();
        const Mat3 R = d.q_b.toRotationMatrix();
        const Vec3 e = part(dx, block.first);
        d.q_b = exp_so3(R.col(1) * e.x() - R.col(0) * e.y()) * d.q_b;
        d.q_b.normalize();
        d.rho += e.z();
        block.set_inverse_depth(d);
        break;
      }
      default:
        for (int i = 0; i < block.size; ++i) block.value[i] += dx[block.first + i];
    }
  }
}

GaugeRows gauge_rows(const State& state, const Block& block) {
  GaugeRows N = GaugeRows::Zero();
  switch (block.kind) {
    case BlockKind::kNone:
      break;
    case BlockKind::kAnchor:
    case BlockKind::kPoint:
      put_place<3>(Mat3::Identity(), block.xyz(), &N);
      break;
    case BlockKind::kInverseDepth: {
      const InverseDepth d = block.inverse_depth();
      const Mat3 R = d.q_b.toRotationMatrix();
      N.block<1, 3>(0, 3) = R.col(1).transpose();
      N.block<1, 3>(1, 3) = -R.col(0).transpose();
      N(2, 6) = -d.rho;
      break;
    }
    case BlockKind::kPlane:
      N.topRows<3>() = plane_gauge(state.frame_of(block), block.xyz());
      break;
    case BlockKind::kPlanePoint: {
      const Block& plane = state.block[block.parent];
      put_coordinates(state.frame_of(plane), plane.xyz(), block.uv(), &N);
      break;
    }
    case BlockKind::kPatch: {
      const Block& plane = state.block[block.parent];
      put_patch(state.frame_of(plane), plane.xyz(), block.patch(), false, Vec2::Zero(), &N);
      break;
    }
    case BlockKind::kPatchPoint: {
      const Block& patch = state.block[block.parent];
      const Block& plane = state.block[patch.parent];
      put_patch(state.frame_of(plane), plane.xyz(), patch.patch(), true, block.uv(), &N);
      break;
    }
  }
  return N;
}

void add_gauge_rows(const State& state, Scalar sign, Scalar* N_T, Scalar* N_R, Scalar* N_s, int ld) {
  const auto add = [&](int first, int size, const GaugeRows& N) {
    for (int i = 0; i < size; ++i) {
      for (int axis = 0; axis < 3; ++axis) {
        if (N_T != nullptr) N_T[axis * ld + first + i] += sign * N(i, axis);
        N_R[axis * ld + first + i] += sign * N(i, 3 + axis);
      }
      N_s[first + i] += sign * N(i, 6);
    }
  };
  for (int axis = 0; axis < 3; ++axis) N_R[axis * ld + Body::kTheta + axis] += sign;
  GaugeRows N = GaugeRows::Zero();
  put_place<3>(Mat3::Identity(), state.body.p_W, &N);
  add(Body::kPosition, 3, N);
  if (state.body_dim > Body::kPoseDim) {
    put_place<3>(Mat3::Identity(), state.body.v_W, &N);
    N.leftCols<3>().setZero();
    add(Body::kVelocity, 3, N);
  }
  for (int s = 0; s < state.slots; ++s) {
    const Block& block = state.block[s];
    if (block.size > 0) add(block.first, block.size, gauge_rows(state, block));
  }
}

}  // namespace pf
