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

/// Slots in the order of their rows.
void Filter::sort_by_rows(int* slots, int count) const {
  for (int i = 1; i < count; ++i) {
    const int slot = slots[i];
    int at = i;
    for (; at > 0 && state_.block[slots[at - 1]].first > state_.block[slot].first; --at) slots[at] = slots[at - 1];
    slots[at] = slot;
  }
}

/// The rows of these blocks, in their order, become J[i] x of the state as it is, all in one pass; blocks behind move up.
void Filter::transform_blocks(const int* slots, const SparseRows* J, int count) {
  Segment old[kMostFolded];
  int gone = 0;
  for (int i = 0; i < count; ++i) {
    Block& block = state_.block[slots[i]];
    old[i] = {block.first, block.size};
    if (J[i].rows < block.size) list_gone(block.first + J[i].rows, block.size - J[i].rows, &gone);
    block.size = static_cast<std::int16_t>(J[i].rows);
  }
  kernels_->transform_many(P_, old, J, count, W_, ld_, S_, lds_);
  move_up(gone);
}

/// Takes in a distance of zero of the chosen ones together. `row` is scratch.
bool Filter::condition_on(int plane, const int* slots, int count, Scalar noise, const unsigned char* folded,
                          SparseRows* row) {
  // The distance grows with the world: H N_s = d. With l, the row that picks the log scale, d - d l . e has none of it.
  SparseRows l;
  if (!keep_gauge_ || !scale_row(&l)) l.segments = 0;
  int m = 0;
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
    y_[m++] = -d;
  }
  if (m == 0) return true;
  kernels_->gather_many(P_, row, m, W_, ld_);
  kernels_->project(W_, m, ld_, row, m, S_, lds_);
  for (int i = 0; i < m; ++i) S_[i * lds_ + i] += noise;
  return apply(m, nullptr);
}

int Filter::fold(int plane, const int* slots, int count, const FoldRule& rule, unsigned char* folded) {
  PF_ASSERT(count <= kMostFolded && 2 * count <= max_rows_);
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
  SparseRows J[kMostFolded];  // also of the distances: the stack is small
  if (rule.condition && !condition_on(plane, slots, count, noise, folded, J)) {
    std::memset(folded, 0, static_cast<std::size_t>(count));
    return 0;
  }
  // The transform: coordinates in the plane, all in one pass.
  const PlaneFrame& frame = state_.frame_of(state_.block[plane]);
  const Mat23 axes = frame.R_WP.transpose().topRows<2>();
  int moved[kMostFolded];
  int done = 0;
  for (int i = 0; i < count; ++i)
    if (folded[i] != 0) moved[done++] = slots[i];
  if (done == 0) return 0;
  sort_by_rows(moved, done);
  for (int i = 0; i < done; ++i) {
    Block& block = state_.block[moved[i]];
    WorldPoint at;
    world_point(state_, moved[i], &at);
    J[i].rows = 2;
    J[i].segments = at.segments;
    for (int s = 0; s < at.segments; ++s) J[i].segment[s] = at.segment[s];
    for (int c = 0; c < at.columns; ++c) {
      const Vec2 h = axes * at.J.col(c);
      J[i].h[c] = h.x();
      J[i].h[at.columns + c] = h.y();
    }
    state_.leave_parent(moved[i]);
    state_.adopt(plane, moved[i]);
    block.kind = BlockKind::kPlanePoint;
    block.set_uv(plane_coordinates(frame, at.p_W));
  }
  transform_blocks(moved, J, done);
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
  augment_block(&block, 3, J, raw);
  state_.leave_parent(slot);
  block.kind = BlockKind::kPoint;
  block.set_xyz(at.p_W);
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
  // The points first: their new coordinates depend on the plane as it was. So it is in the last of the passes.
  const Mat23 axes = frame.R_WP.transpose().topRows<2>();
  SparseRows J[kMostFolded];
  int moved[kMostFolded];
  int count = 0;
  const int most = max_rows_ / 3 < kMostFolded ? max_rows_ / 3 : kMostFolded;
  const auto move = [&] {
    sort_by_rows(moved, count);
    for (int i = 0; i < count; ++i) {
      Block& at = state_.block[moved[i]];
      J[i].segment[0] = {block.first, 3};
      if (moved[i] == plane) {
        J[i].rows = 3;
        J[i].segments = 1;
        put<3, 3>(J[i].h, 3, 0, J_x);
        continue;
      }
      Mat3 J_p_x;
      Mat32 J_p_uv;
      const Vec3 p_W = plane_point(old, block.xyz(), at.uv(), &J_p_x, &J_p_uv);
      J[i].rows = 2;
      J[i].segments = 2;
      J[i].segment[1] = {at.first, 2};
      const Mat23 by_plane = axes * J_p_x;
      const Mat2 by_uv = axes * J_p_uv;
      put<2, 3>(J[i].h, 5, 0, by_plane);
      put<2, 2>(J[i].h, 5, 3, by_uv);
      at.set_uv(plane_coordinates(frame, p_W));
    }
    transform_blocks(moved, J, count);
    count = 0;
  };
  for (int s = 0; s < state_.slots; ++s) {
    if (state_.block[s].kind != BlockKind::kPlanePoint || state_.block[s].parent != plane) continue;
    if (count + 1 == most) move();
    moved[count++] = s;
  }
  moved[count++] = plane;
  move();
  block.set_xyz(x);
  state_.plane_frame[block.frame] = frame;
  return true;
}

}  // namespace pf
