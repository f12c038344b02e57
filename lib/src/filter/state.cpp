#include "filter/state.h"

#include "geometry/so3.h"

namespace pf {
namespace {

Vec3 part(const Scalar* dx, int first) { return Vec3(dx[first], dx[first + 1], dx[first + 2]); }

/// Three rows (one per axis of the turn) of -[a]x, transposed, at columns first .. first+2.
void add_turn(Scalar* N_R, int ld, int first, Scalar sign, const Vec3& a) {
  const Mat3 m = hat(a);
  for (int axis = 0; axis < 3; ++axis)
    for (int i = 0; i < 3; ++i) N_R[axis * ld + first + i] -= sign * m(i, axis);
}

void add_three(Scalar* row, int first, Scalar sign, const Vec3& a) {
  for (int i = 0; i < 3; ++i) row[first + i] += sign * a[i];
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
      case BlockKind::kAnchor:
      case BlockKind::kPoint:
        block.set_xyz(block.xyz() + part(dx, block.first));
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
    }
  }
}

void add_gauge_rows(const State& state, Scalar sign, Scalar* N_R, Scalar* N_s, int ld) {
  for (int axis = 0; axis < 3; ++axis) N_R[axis * ld + Body::kTheta + axis] += sign;
  add_turn(N_R, ld, Body::kPosition, sign, state.body.p_W);
  add_three(N_s, Body::kPosition, sign, state.body.p_W);
  if (state.body_dim > Body::kPoseDim) {
    add_turn(N_R, ld, Body::kVelocity, sign, state.body.v_W);
    add_three(N_s, Body::kVelocity, sign, state.body.v_W);
  }
  for (int s = 0; s < state.slots; ++s) {
    const Block& block = state.block[s];
    switch (block.kind) {
      case BlockKind::kNone:
        break;
      case BlockKind::kAnchor:
      case BlockKind::kPoint:
        add_turn(N_R, ld, block.first, sign, block.xyz());
        add_three(N_s, block.first, sign, block.xyz());
        break;
      case BlockKind::kInverseDepth: {
        const InverseDepth d = block.inverse_depth();
        const Mat3 R = d.q_b.toRotationMatrix();
        for (int axis = 0; axis < 3; ++axis) {
          N_R[axis * ld + block.first] += sign * R(axis, 1);
          N_R[axis * ld + block.first + 1] -= sign * R(axis, 0);
        }
        N_s[block.first + 2] -= sign * d.rho;
        break;
      }
    }
  }
}

}  // namespace pf
