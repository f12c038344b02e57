#include "filter/filter.h"

#include <cstring>

#include "filter/observe/row.h"
#include "filter/observe/world_point.h"
#include "filter/put.h"

namespace pf {
namespace {

int round_to_group(int n) { return (n + Triangle::kGroup - 1) / Triangle::kGroup * Triangle::kGroup; }

}  // namespace

bool Filter::layout(Arena& arena, const FilterCapacity& capacity) {
  most_rows_ = capacity.state_dim;
  P_.capacity = round_to_group(capacity.state_dim);
  P_.data = arena.take<Scalar>(Triangle::size_for(P_.capacity));
  // Features, planes with their patches, and anchors with a child each (six rows).
  state_.slots = capacity.features + 2 * capacity.planes + capacity.state_dim / 6 + 1;
  state_.block = arena.take<Block>(static_cast<std::size_t>(state_.slots));
  max_rows_ = 2 * capacity.observations;
  ld_ = padded(P_.capacity);
  lds_ = padded(max_rows_);
  const std::size_t ld = static_cast<std::size_t>(ld_);
  W_ = arena.take<Scalar>(static_cast<std::size_t>(max_rows_) * ld);
  S_ = arena.take<Scalar>(static_cast<std::size_t>(max_rows_) * static_cast<std::size_t>(lds_));
  U_ = arena.take<Scalar>(kGaugeRows * ld);
  G_ = arena.take<Scalar>(kGaugeRows * ld);
  dx_ = arena.take<Scalar>(ld);
  y_ = arena.take<Scalar>(static_cast<std::size_t>(max_rows_));
  gone_ = arena.take<Segment>(static_cast<std::size_t>(state_.slots));
  order_ = arena.take<int>(ld);
  place_ = arena.take<Vec3>(static_cast<std::size_t>(state_.slots));
  place_slot_ = arena.take<int>(static_cast<std::size_t>(state_.slots));
  state_.max_planes = capacity.planes;
  state_.plane_frame = arena.take<PlaneFrame>(static_cast<std::size_t>(capacity.planes));
  return arena.ok();
}

void Filter::init(const Kernels* kernels, int body_dim, bool keep_gauge) {
  kernels_ = kernels;
  keep_gauge_ = keep_gauge;
  for (int s = 0; s < state_.slots; ++s) state_.block[s] = Block();
  state_.body = Body();
  state_.body_dim = body_dim;
  state_.dim = body_dim;
  state_.held_dim = 0;
  state_.planes = 0;
  roughness_ = Scalar(0);
  P_.n = body_dim;
  std::memset(P_.data, 0, sizeof(Scalar) * Triangle::size_for(P_.capacity));
  const std::size_t ld = static_cast<std::size_t>(ld_);
  std::memset(W_, 0, sizeof(Scalar) * static_cast<std::size_t>(max_rows_) * ld);
  std::memset(U_, 0, sizeof(Scalar) * kGaugeRows * ld);
  std::memset(G_, 0, sizeof(Scalar) * kGaugeRows * ld);
}

void Filter::set_body(const Body& body, const Scalar* covariance) {
  PF_ASSERT(state_.dim == state_.body_dim);
  state_.body = body;
  for (int i = 0; i < state_.body_dim; ++i)
    for (int j = 0; j <= i; ++j) P_.set(i, j, covariance[i * state_.body_dim + j]);
}

void Filter::predict(const Transition& transition) {
  kernels_->predict(P_, transition.F, transition.Q, transition.dim);
}

void Filter::steer(const Vec3& dv_C, const Vec3& dw_C) {
  PF_ASSERT(state_.body_dim == Body::kMaxDim);
  const Vec3 dv_W = state_.body.q_WC * dv_C;
  state_.body.v_W += dv_W;
  state_.body.w_C += dw_C;
  if (dv_W.squaredNorm() == Scalar(0)) return;
  Transition turn = {};
  turn.dim = Body::kMaxDim;
  for (int i = 0; i < turn.dim; ++i) turn.F[i * turn.dim + i] = Scalar(1);
  const Mat3 J = -hat(dv_W);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) turn.F[(Body::kVelocity + i) * turn.dim + Body::kTheta + j] = J(i, j);
  kernels_->predict(P_, turn.F, turn.Q, turn.dim);
}

int Filter::take_slot(BlockKind kind, int size) {
  const int slot = state_.find_free();
  if (slot < 0 || state_.dim + size > most_rows_) return -1;
  Block& block = state_.block[slot];
  block = Block();
  block.kind = kind;
  block.first = static_cast<std::int16_t>(state_.dim);
  block.size = static_cast<std::int16_t>(size);
  return slot;
}

int Filter::add_anchor() {
  const int slot = take_slot(BlockKind::kAnchor, 3);
  if (slot < 0) return -1;
  SparseRows J;  // o = p
  J.rows = 3;
  J.segments = 1;
  J.segment[0] = {Body::kPosition, 3};
  put<3, 3>(J.h, 3, 0, Mat3::Identity());
  const Scalar none[9] = {};
  kernels_->augment(P_, J, none);
  state_.block[slot].set_xyz(state_.body.p_W);
  state_.dim = P_.n;
  return slot;
}

int Filter::add_inverse_depth(int anchor, const Vec3& ray_C, const Mat32& J_ray_z, const Mat2& noise_px, Scalar rho,
                              Scalar sigma_rho, Scalar tau) {
  PF_ASSERT(state_.block[anchor].kind == BlockKind::kAnchor);
  const int slot = take_slot(BlockKind::kInverseDepth, 3);
  if (slot < 0) return -1;
  const RowBody row = body_at_row(state_.body, state_.body_dim == Body::kMaxDim ? tau : Scalar(0));
  const Vec3 c_W = row.body.p_W - state_.body.p_W;
  Mat23 J_theta, J_c;
  Mat2 J_z;
  const InverseDepth feature = begin_inverse_depth(row.body, ray_C, J_ray_z, rho, c_W, &J_theta, &J_z, &J_c);
  SparseRows J;
  J.rows = 3;
  J.segments = 1;
  J.segment[0] = {Body::kTheta, row.tau == Scalar(0) ? 3 : Body::kMaxDim};
  const int columns = J.segment[0].size;
  for (int i = 0; i < 3 * columns; ++i) J.h[i] = Scalar(0);
  put<2, 3>(J.h, columns, 0, J_theta);
  if (row.tau != Scalar(0)) {
    put<2, 3>(J.h, columns, Body::kVelocity, Mat23(row.tau * J_c));
    put<2, 3>(J.h, columns, Body::kRate, Mat23(J_theta.lazyProduct(row.J_theta_w)));
  }
  // Of the pixel, and of the inverse depth, which turns the bearing too where the anchor is not where the ray begins.
  Mat3 noise = Mat3::Zero();
  const Mat2 Jn = J_z * noise_px;
  const Vec2 J_rho = J_c.lazyProduct(c_W) / rho;
  noise.topLeftCorner<2, 2>() = Jn * J_z.transpose() + sigma_rho * sigma_rho * J_rho * J_rho.transpose();
  noise.topRightCorner<2, 1>() = sigma_rho * sigma_rho * J_rho;
  noise.bottomLeftCorner<1, 2>() = noise.topRightCorner<2, 1>().transpose();
  noise(2, 2) = sigma_rho * sigma_rho;
  Scalar raw[9];
  put<3, 3>(raw, 3, 0, noise);
  kernels_->augment(P_, J, raw);
  state_.block[slot].set_inverse_depth(feature);
  state_.adopt(anchor, slot);
  state_.dim = P_.n;
  return slot;
}

int Filter::add_point(const Vec3& p_W, const Mat3& covariance) {
  const int slot = take_slot(BlockKind::kPoint, 3);
  if (slot < 0) return -1;
  SparseRows J;
  J.rows = 3;
  J.segments = 0;
  Scalar raw[9];
  put<3, 3>(raw, 3, 0, covariance);
  kernels_->augment(P_, J, raw);
  state_.block[slot].set_xyz(p_W);
  state_.dim = P_.n;
  return slot;
}

void Filter::convert_to_point(int slot) {
  Block& block = state_.block[slot];
  PF_ASSERT(block.kind == BlockKind::kInverseDepth);
  const int anchor = block.parent;
  Mat3 J_feature;
  const Vec3 f_W = inverse_depth_to_point(state_.block[anchor].xyz(), block.inverse_depth(), &J_feature);
  SparseRows J;  // f = o + b / rho
  J.rows = 3;
  J.segments = 2;
  J.segment[0] = {state_.block[anchor].first, 3};
  J.segment[1] = {block.first, 3};
  put<3, 3>(J.h, 6, 0, Mat3::Identity());
  put<3, 3>(J.h, 6, 3, J_feature);
  kernels_->transform(P_, block.first, 3, J, nullptr);
  state_.leave_parent(slot);
  block.kind = BlockKind::kPoint;
  block.set_xyz(f_W);
  if (state_.block[anchor].children == 0) remove(&anchor, 1);
}

void Filter::remove(const int* slots, int count) {
  // Mark, let anchors and patches follow their last child, then list what goes.
  for (int i = 0; i < count; ++i) {
    Block& block = state_.block[slots[i]];
    PF_ASSERT(block.kind != BlockKind::kPlane || block.children == 0);
    state_.leave_parent(slots[i]);
    if (block.kind == BlockKind::kPlane) --state_.planes;
    block.kind = BlockKind::kNone;
  }
  for (int s = 0; s < state_.slots; ++s) {
    Block& block = state_.block[s];
    if ((block.kind != BlockKind::kAnchor && block.kind != BlockKind::kPatch) || block.children > 0) continue;
    state_.leave_parent(s);
    block.kind = BlockKind::kNone;
  }
  int gone = 0;
  for (int s = 0; s < state_.slots; ++s) {
    Block& block = state_.block[s];
    if (block.kind != BlockKind::kNone) continue;
    if (block.size > 0) list_gone(block.first, block.size, &gone);
    block = Block();
  }
  close_gaps(gone);
}

/// Rows that go, kept in ascending order.
void Filter::list_gone(int first, int size, int* gone) {
  int at = (*gone)++;
  for (; at > 0 && gone_[at - 1].first > first; --at) gone_[at] = gone_[at - 1];
  gone_[at] = {first, size};
}

/// Removes the listed rows in one pass.
void Filter::close_gaps(int gone) {
  if (gone == 0) return;
  kernels_->remove(P_, gone_, gone);
  move_up(gone);
}

/// Blocks behind the listed rows, which the matrix has no more, move up.
void Filter::move_up(int gone) {
  for (int s = 0; s < state_.slots; ++s) {
    Block& block = state_.block[s];
    if (block.size == 0) continue;
    int shift = 0;
    for (int g = 0; g < gone && gone_[g].first < block.first; ++g) shift += gone_[g].size;
    block.first = static_cast<std::int16_t>(block.first - shift);
  }
  const int held_end = state_.held_end();
  for (int g = 0; g < gone; ++g)
    if (gone_[g].first < held_end) state_.held_dim -= gone_[g].size;
  state_.dim = P_.n;
}

/// New rows behind all others for a block; the caller lets its old ones go.
void Filter::augment_block(Block* block, int size, const SparseRows& J, const Scalar* noise) {
  block->first = static_cast<std::int16_t>(state_.dim);
  block->size = static_cast<std::int16_t>(size);
  kernels_->augment(P_, J, noise);
  state_.dim = P_.n;
}

Vec3 Filter::point(int slot) const {
  const Block& block = state_.block[slot];
  if (block.kind == BlockKind::kPlanePoint) {
    const Block& plane = state_.block[block.parent];
    return plane_point(state_.frame_of(plane), plane.xyz(), block.uv());
  }
  if (block.kind == BlockKind::kPatchPoint) {
    const Block& patch = state_.block[block.parent];
    const Block& plane = state_.block[patch.parent];
    const Patch drawing = patch.patch();
    const Vec2 uv = drawing.t + drawing.linear() * block.uv();
    return plane_point(state_.frame_of(plane), plane.xyz(), uv);
  }
  if (block.kind != BlockKind::kInverseDepth) return block.xyz();
  const InverseDepth d = block.inverse_depth();
  const Scalar rho = d.rho > kMinShownInverseDepth ? d.rho : kMinShownInverseDepth;
  return state_.block[block.parent].xyz() + d.q_b.toRotationMatrix().col(2) / rho;
}

Mat3 Filter::covariance3(int slot) const {
  WorldPoint at;
  Mat32 J_c;
  Mat3 C = Mat3::Zero();
  const Block& block = state_.block[slot];
  if (block.kind == BlockKind::kInverseDepth && !(block.inverse_depth().rho > kMinShownInverseDepth)) {
    const Block& anchor = state_.block[block.parent];
    Mat6 cov;
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 6; ++j)
        cov(i, j) = P_(i < 3 ? anchor.first + i : block.first + i - 3, j < 3 ? anchor.first + j : block.first + j - 3);
    shown_place(anchor.xyz(), block.inverse_depth(), cov, &C);
    return C;
  }
  if (!world_point(state_, slot, &at, &J_c)) return C;
  int column[WorldPoint::kMaxColumns];
  int c = 0;
  for (int s = 0; s < at.segments; ++s)
    for (int i = 0; i < at.segment[s].size; ++i) column[c++] = at.segment[s].first + i;
  for (int i = 0; i < c; ++i) {
    Vec3 PJ = Vec3::Zero();  // row i of P J^T
    for (int j = 0; j < c; ++j) PJ += P_(column[i], column[j]) * at.J.col(j);
    C += at.J.col(i) * PJ.transpose();
  }
  if (block.kind == BlockKind::kPatchPoint && block.size == 0) {
    C += J_c * block.inside() * J_c.transpose();
  }
  return C;
}

}  // namespace pf
