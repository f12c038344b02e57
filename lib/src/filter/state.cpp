#include "filter/state.h"

#include "base/assert.h"
#include "filter/block_filter.h"
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

/// Rows of what has two coordinates in a plane or patch, which are affine in them:  N(c) = at + c_0 by_u + c_1 by_v.
struct PlanarRows {
  using Rows = Eigen::Matrix<Scalar, 2, 7>;
  Rows at, by_u, by_v;

  /// (u, v) of a point p of the plane: the first rows of R_WPᵀ (I, -[p]x, p).
  void of_plane(const PlaneFrame& frame, const Vec3& x) {
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
  /// Coordinates in a patch, from the rows of its plane: what each direction does to M beside turning and growing it.
  void of_patch(const PlanarRows& plane, const Patch& patch) {
    const Scalar cosine = std::cos(patch.phi), sine = std::sin(patch.phi);
    Mat2 turn;
    turn << cosine, -sine, sine, cosine;
    at.setZero();
    for (int d = 0; d < 7; ++d) {
      Mat2 M;
      M.col(0) = plane.by_u.col(d);
      M.col(1) = plane.by_v.col(d);
      const Scalar lambda = (M(0, 0) + M(1, 1)) / 2, phi = (M(1, 0) - M(0, 1)) / 2;
      M(0, 0) -= lambda;
      M(1, 1) -= lambda;
      M(1, 0) -= phi;
      M(0, 1) += phi;
      const Mat2 S = turn.transpose() * (M * turn);
      by_u.col(d) = S.col(0);
      by_v.col(d) = S.col(1);
    }
  }
  Scalar operator()(int i, int d, const Vec2& c) const { return at(i, d) + c.x() * by_u(i, d) + c.y() * by_v(i, d); }

 private:
  static void put(int i, const Vec3& axis, const Vec3& p_W, Rows* N) {
    const Vec3 turn = p_W.cross(axis);  // -axisᵀ [p]x
    for (int k = 0; k < 3; ++k) (*N)(i, 3 + k) = turn(k);
    (*N)(i, 6) = axis.dot(p_W);
  }
};

/// Of a plane, or of a patch on one.
void find_rows(const State& state, const Block& parent, PlanarRows* rows) {
  const Block& plane = parent.kind == BlockKind::kPlane ? parent : state.block[parent.parent];
  PlanarRows of_plane;
  of_plane.of_plane(state.frame_of(plane), plane.xyz());
  if (parent.kind == BlockKind::kPlane)
    *rows = of_plane;
  else
    rows->of_patch(of_plane, parent.patch());
}

/// What each direction does to (u, v) at the patch, and how it turns and scales it.
void put_patch(const PlanarRows& plane, const Patch& patch, GaugeRows* N) {
  for (int d = 0; d < 7; ++d) {
    for (int i = 0; i < 2; ++i) (*N)(i, d) = plane(i, d, patch.t);
    (*N)(2, d) = (plane.by_u(1, d) - plane.by_v(0, d)) / 2;
    (*N)(3, d) = (plane.by_u(0, d) + plane.by_v(1, d)) / 2;
  }
}

/// (I, -[p]x, p)
void add_point_rows(Scalar sign, int first, const Vec3& p_W, Scalar* N_T, Scalar* N_R, Scalar* N_s, int ld) {
  const Vec3 p = sign * p_W;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    if (N_T != nullptr) N_T[i * ld + first + i] += sign;
    N_R[j * ld + first + i] += p(k);
    N_R[k * ld + first + i] -= p(j);
    N_s[first + i] += p(i);
  }
}

}  // namespace

void State::adopt(int parent, int child) {
  Block& c = block[child];
  PF_ASSERT(c.parent < 0);
  std::int16_t* link = &block[parent].first_child;
  while (*link >= 0 && block[*link].owner <= c.owner) link = &block[*link].next_sibling;
  c.parent = static_cast<std::int16_t>(parent);
  c.next_sibling = *link;
  *link = static_cast<std::int16_t>(child);
  ++block[parent].children;
}

void State::leave_parent(int child) {
  Block& c = block[child];
  if (c.parent < 0) return;
  std::int16_t* link = &block[c.parent].first_child;
  while (*link != child) link = &block[*link].next_sibling;
  *link = c.next_sibling;
  --block[c.parent].children;
  c.parent = c.next_sibling = -1;
}

void State::set_owner(int slot, int owner) {
  const int parent = block[slot].parent;
  leave_parent(slot);
  block[slot].owner = static_cast<std::int16_t>(owner);
  if (parent >= 0) adopt(parent, slot);
}

void apply_error(State& state, const BlockFilter& blocks, const Scalar* dx) {
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
        const Vec3 e = part(dx, blocks.first(s));
        d.q_b = exp_so3(R.col(1) * e.x() - R.col(0) * e.y()) * d.q_b;
        d.q_b.normalize();
        d.rho += e.z();
        block.set_inverse_depth(d);
        break;
      }
      default:
        for (int i = 0; i < block.size; ++i) block.value[i] += dx[blocks.first(s) + i];
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
    case BlockKind::kPatch: {
      PlanarRows rows;
      find_rows(state, state.block[block.parent], &rows);
      put_patch(rows, block.patch(), &N);
      break;
    }
    case BlockKind::kPlanePoint:
    case BlockKind::kPatchPoint: {
      PlanarRows rows;
      find_rows(state, state.block[block.parent], &rows);
      for (int i = 0; i < 2; ++i)
        for (int d = 0; d < 7; ++d) N(i, d) = rows(i, d, block.uv());
      break;
    }
  }
  return N;
}

void add_gauge_rows(const State& state, const BlockFilter& blocks, Scalar sign, Scalar* N_T, Scalar* N_R, Scalar* N_s,
                    int ld) {
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
    if (block.kind == BlockKind::kPoint || block.kind == BlockKind::kAnchor) {
      add_point_rows(sign, blocks.first(s), block.xyz(), N_T, N_R, N_s, ld);
    } else if (block.size > 0 && !is_planar(block.kind)) {
      add(blocks.first(s), block.size, gauge_rows(state, block));
    }
    // What hangs on a plane or patch shares the rows that its own are made of.
    if ((block.kind != BlockKind::kPlane && block.kind != BlockKind::kPatch) || block.children == 0) continue;
    PlanarRows rows;
    find_rows(state, block, &rows);
    for (int t = block.first_child; t >= 0; t = state.block[t].next_sibling) {
      const Block& child = state.block[t];
      if (child.size == 0 || !is_planar(child.kind)) continue;
      const Vec2 c = child.uv();
      for (int i = 0; i < 2; ++i) {
        const int at = blocks.first(t) + i;
        for (int axis = 0; axis < 3; ++axis) {
          if (N_T != nullptr) N_T[axis * ld + at] += sign * rows(i, axis, c);
          N_R[axis * ld + at] += sign * rows(i, 3 + axis, c);
        }
        N_s[at] += sign * rows(i, 6, c);
      }
    }
  }
}

}  // namespace pf
