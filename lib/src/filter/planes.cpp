#include <cstring>

#include "filter/filter.h"
#include "filter/observe/world_point.h"
#include "filter/put.h"

/// Planes in the state: begun, points folded into them and out of them, moved to another frame.

namespace pf {

int Filter::add_plane(const PlaneFit& fit, const int* slots, int count, Scalar roughness) {
  if (state_.planes >= state_.max_planes || max_rows_ < 6) return -1;
  const int slot = take_slot(BlockKind::kPlane, 3);
  if (slot < 0) return -1;
  // J P, point by point, summed up in W_.
  const int n = state_.dim;
  std::memset(W_, 0, 3 * sizeof(Scalar) * static_cast<std::size_t>(ld_));
  Mat3 noise = Mat3::Zero();
  SparseRows J;
  J.rows = 3;
  for (int k = 0; k < count; ++k) {
    const Block& point = state_.block[slots[k]];
    PF_ASSERT(point.kind == BlockKind::kPoint);
    const Mat3 J_point = fit_plane_jacobian(fit, point.xyz());
    J.segments = 1;
    J.segment[0] = {point.first, 3};
    put<3, 3>(J.h, 3, 0, J_point);
    kernels_->gather(P_, J, W_ + 3 * ld_, ld_);
    for (int i = 0; i < 3 * ld_; ++i) W_[i] += W_[3 * ld_ + i];
    const Vec3 rough = roughness * (J_point * fit.frame.R_WP.col(2));
    noise += rough * rough.transpose();
  }
  for (int k = 0; k < count; ++k) {
    const Block& point = state_.block[slots[k]];
    const Mat3 J_point = fit_plane_jacobian(fit, point.xyz());
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        for (int c = 0; c < 3; ++c) noise(i, j) += W_[i * ld_ + point.first + c] * J_point(j, c);
  }
  Scalar raw[9];
  const Mat3 symmetric = (noise + noise.transpose()) / Scalar(2);
  put<3, 3>(raw, 3, 0, symmetric);
  J.segments = 0;
  kernels_->augment(P_, J, raw);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < n; ++j) P_.set(n + i, j, W_[i * ld_ + j]);
  state_.dim = P_.n;

  Block& block = state_.block[slot];
  block.set_xyz(Vec3::Zero());
  for (int frame = 0; frame < state_.max_planes; ++frame) {
    bool free = true;
    for (int s = 0; s < state_.slots; ++s)
      if (state_.block[s].kind == BlockKind::kPlane && state_.block[s].frame == frame) free = false;
    if (!free) continue;
    block.frame = static_cast<std::int16_t>(frame);
    break;
  }
  state_.plane_frame[block.frame] = fit.frame;
  ++state_.planes;
  return slot;
}

/// d = n . p - d_W of a place, and its row over plane and place.
void Filter::distance_row(int plane, const WorldPoint& at, Scalar* d, SparseRows* row) const {
  const Block& block = state_.block[plane];
  Mat13 J_x, J_p;
  *d = plane_distance(state_.frame_of(block), block.xyz(), at.p_W, &J_x, &J_p);
  row->rows = 1;
  row->segments = 1;
  row->segment[0] = {block.first, 3};
  for (int i = 0; i < 3; ++i) row->h[i] = J_x(i);
  int column = 0;
  for (int s = 0; s < at.segments; ++s) {
    Scalar h[WorldPoint::kMaxColumns];
    for (int i = 0; i < at.segment[s].size; ++i) h[i] = J_p.transpose().dot(at.J.col(column++));
    add_segment(row, at.segment[s], h);
  }
}

bool Filter::distance(int plane, int slot, Scalar* d, Scalar* variance) const {
  WorldPoint at;
  if (!world_point(state_, slot, &at)) return false;
  SparseRows row;
  distance_row(plane, at, d, &row);
  *variance = variance_of(row);
  return true;
}

int Filter::fold(int plane, const int* slots, int count, const FoldRule& rule, unsigned char* folded) {
  PF_ASSERT(count <= kMostFolded && count <= max_rows_);
  const Scalar noise = rule.roughness * rule.roughness;
  for (int i = 0; i < count; ++i) {
    Scalar d, variance;
    const BlockKind kind = state_.block[slots[i]].kind;
    folded[i] = 0;
    if (kind != BlockKind::kPoint && (kind != BlockKind::kPlanePoint || state_.block[slots[i]].parent == plane))
      continue;
    if (!distance(plane, slots[i], &d, &variance)) continue;
    folded[i] = d * d < rule.gate * (variance + noise) ? 1 : 0;
  }
  if (rule.condition) {
    // The distance grows with the world: H N_s = d. With l, the row that picks the log scale, d - d l . e has none of it.
    SparseRows l;
    if (!keep_gauge_ || !scale_row(&l)) l.segments = 0;
    int m = 0;
    SparseRows row[kMostFolded];
    for (int i = 0; i < count; ++i) {
      if (folded[i] == 0) continue;
      WorldPoint at;
      Scalar d;
      world_point(state_, slots[i], &at);
      distance_row(plane, at, &d, &row[m]);
      for (int s = 0, from = 0; s < l.segments; ++s) {
        Scalar h[Observation::kMaxColumns];
        for (int k = 0; k < l.segment[s].size; ++k) h[k] = -d * l.h[from++];
        add_segment(&row[m], l.segment[s], h);
      }
      kernels_->gather(P_, row[m], W_ + m * ld_, ld_);
      y_[m++] = -d;
    }
    for (int i = 0; i < m; ++i) {
      for (int j = 0; j <= i; ++j) {
        Scalar sum = i == j ? noise : Scalar(0);
        int c = 0;
        for (int s = 0; s < row[i].segments; ++s)
          for (int k = 0; k < row[i].segment[s].size; ++k)
            sum += row[i].h[c++] * W_[j * ld_ + row[i].segment[s].first + k];
        S_[i * lds_ + j] = sum;
      }
    }
    if (m > 0 && !apply(m, nullptr)) {
      std::memset(folded, 0, static_cast<std::size_t>(count));
      return 0;
    }
  }
  // The transform: coordinates in the plane, all gaps closed in one pass.
  const PlaneFrame& frame = state_.frame_of(state_.block[plane]);
  const Mat23 axes = frame.R_WP.transpose().topRows<2>();
  int done = 0, gone = 0;
  for (int i = 0; i < count; ++i) {
    if (folded[i] == 0) continue;
    Block& block = state_.block[slots[i]];
    WorldPoint at;
    world_point(state_, slots[i], &at);
    SparseRows J;
    J.rows = 2;
    J.segments = at.segments;
    for (int s = 0; s < at.segments; ++s) J.segment[s] = at.segment[s];
    for (int c = 0; c < at.columns; ++c) {
      const Vec2 h = axes * at.J.col(c);
      J.h[c] = h.x();
      J.h[at.columns + c] = h.y();
    }
    kernels_->replace(P_, block.first, block.size, J, nullptr);
    if (block.size > 2) list_gone(block.first + 2, block.size - 2, &gone);
    if (block.parent >= 0) --state_.block[block.parent].children;
    block.kind = BlockKind::kPlanePoint;
    block.size = 2;
    block.parent = static_cast<std::int16_t>(plane);
    block.set_uv(plane_coordinates(frame, at.p_W));
    ++state_.block[plane].children;
    ++done;
  }
  close_gaps(gone);
  return done;
}

bool Filter::unfold(int slot, Scalar sigma_normal) {
  Block& block = state_.block[slot];
  PF_ASSERT(is_planar(block.kind));
  if (room() < 3) return false;
  WorldPoint at;
  Mat32 J_p_c = Mat32::Zero();
  world_point(state_, slot, &at, &J_p_c);
  SparseRows J;
  J.rows = 3;
  J.segments = at.segments;
  for (int s = 0; s < at.segments; ++s) J.segment[s] = at.segment[s];
  for (int c = 0; c < at.columns; ++c)
    for (int i = 0; i < 3; ++i) J.h[i * at.columns + c] = at.J(i, c);
  const Block& plane = state_.block[state_.plane_of(slot)];
  Vec3 normal;
  Scalar d;
  plane_normal(state_.frame_of(plane), plane.xyz(), &normal, &d);
  Mat3 noise = sigma_normal * sigma_normal * normal * normal.transpose();
  if (block.kind == BlockKind::kPatchPoint && block.size == 0) noise += J_p_c * block.inside() * J_p_c.transpose();
  Scalar raw[9];
  put<3, 3>(raw, 3, 0, noise);
  const Segment old = {block.first, block.size};
  const int parent = block.parent;
  augment_block(&block, 3, J, raw);
  block.kind = BlockKind::kPoint;
  block.parent = -1;
  block.set_xyz(at.p_W);
  --state_.block[parent].children;
  int gone = 0;
  if (old.size > 0) list_gone(old.first, old.size, &gone);
  close_gaps(gone);
  remove(nullptr, 0);  // a patch that nothing hangs on any more
  return true;
}

void Filter::inflate(int plane, const Mat3& Q) {
  const int first = state_.block[plane].first;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j <= i; ++j) P_.set(first + i, first + j, P_(first + i, first + j) + Q(i, j));
}

bool Filter::reanchor(int plane, const PlaneFrame& frame) {
  Block& block = state_.block[plane];
  const PlaneFrame old = state_.frame_of(block);
  Vec3 x;
  Mat3 J_x;
  if (patch_of(plane) >= 0 || !reframe_plane(old, block.xyz(), frame, &x, &J_x)) return false;
  // The points first: their new coordinates depend on the plane as it was.
  const Mat23 axes = frame.R_WP.transpose().topRows<2>();
  for (int s = 0; s < state_.slots; ++s) {
    Block& point = state_.block[s];
    if (point.kind != BlockKind::kPlanePoint || point.parent != plane) continue;
    Mat3 J_p_x;
    Mat32 J_p_uv;
    const Vec3 p_W = plane_point(old, block.xyz(), point.uv(), &J_p_x, &J_p_uv);
    SparseRows J;
    J.rows = 2;
    J.segments = 2;
    J.segment[0] = {block.first, 3};
    J.segment[1] = {point.first, 2};
    const Mat23 by_plane = axes * J_p_x;
    const Mat2 by_uv = axes * J_p_uv;
    put<2, 3>(J.h, 5, 0, by_plane);
    put<2, 2>(J.h, 5, 3, by_uv);
    kernels_->replace(P_, point.first, 2, J, nullptr);
    point.set_uv(plane_coordinates(frame, p_W));
  }
  SparseRows J;
  J.rows = 3;
  J.segments = 1;
  J.segment[0] = {block.first, 3};
  put<3, 3>(J.h, 3, 0, J_x);
  kernels_->replace(P_, block.first, 3, J, nullptr);
  block.set_xyz(x);
  state_.plane_frame[block.frame] = frame;
  return true;
}

}  // namespace pf
