#include <cmath>
#include <cstring>

#include "covariance/open_gap.h"
#include "filter/filter.h"
#include "filter/observe/world_point.h"
#include "filter/put.h"

/// Fixed points. What is known well of a point on a plane is not where it is, for that carries the whole map's drift, but how it lies
/// among the other points of its plane. So these are fixed in a patch, a drawing that moves as one and stays in the state.

namespace pf {
namespace {

using Mat24 = Eigen::Matrix<Scalar, 2, 4>;

/// d(u, v) / d(t, phi, lambda) for a point at uv, about a patch at t: [I, J d, d], d = uv - t.
Mat24 similarity_rows(const Vec2& d) {
  Mat24 A = Mat24::Zero();
  A(0, 0) = A(1, 1) = Scalar(1);
  A(0, 2) = -d.y();
  A(1, 2) = d.x();
  A(0, 3) = d.x();
  A(1, 3) = d.y();
  return A;
}

/// How a patch follows a group of points: the affine map that fits their errors best has the shift e_t and the linear part
/// sum e_uv (D^-1 d)^T, D = sum d d^T, d = uv - middle; the patch takes what turns (phi) and grows (lambda) of it:
///
///   e_phi = sum (e_v g_u - e_u g_v) / 2,   e_lambda = sum (e_u g_u + e_v g_v) / 2,   g = D^-1 d
///
/// By way of the affine map and not by a similarity fit, so that it does to the patch exactly what moving the world does.
struct GroupFit {
  Vec2 middle = Vec2::Zero();
  Mat2 D_inverse = Mat2::Zero();
  int count = 0;

  /// False where the points do not span an area.
  bool fit(const State& state, const int* group, int group_count) {
    count = group_count;
    middle.setZero();
    for (int i = 0; i < count; ++i) middle += state.block[group[i]].uv() / static_cast<Scalar>(count);
    Mat2 D = Mat2::Zero();
    for (int i = 0; i < count; ++i) {
      const Vec2 d = state.block[group[i]].uv() - middle;
      D += d * d.transpose();
    }
    const Scalar trace = D(0, 0) + D(1, 1), det = D(0, 0) * D(1, 1) - D(0, 1) * D(0, 1);
    if (count < 4 || !(det > Scalar(0.01) * trace * trace)) return false;
    D_inverse << D(1, 1) / det, -D(0, 1) / det, -D(0, 1) / det, D(0, 0) / det;
    return true;
  }
  /// 4x2: what one point's coordinates do to the patch.
  Eigen::Matrix<Scalar, 4, 2> by_point(const Vec2& uv) const {
    const Vec2 g = D_inverse * (uv - middle) / Scalar(2);
    const Scalar share = Scalar(1) / static_cast<Scalar>(count);
    Eigen::Matrix<Scalar, 4, 2> J;
    J << share, 0, 0, share, -g.y(), g.x(), g.x(), g.y();
    return J;
  }
};

Scalar largest_eigenvalue(const Mat2& C) {
  const Scalar half = (C(0, 0) + C(1, 1)) / 2, diff = (C(0, 0) - C(1, 1)) / 2;
  return half + std::sqrt(diff * diff + C(0, 1) * C(0, 1));
}

}  // namespace

int Filter::patch_of(int plane) const {
  for (int s = 0; s < state_.slots; ++s)
    if (state_.block[s].kind == BlockKind::kPatch && state_.block[s].parent == plane) return s;
  return -1;
}

Scalar Filter::variance_in_drawing(int slot, const int* group, int group_count) const {
  const Block& block = state_.block[slot];
  PF_ASSERT(block.kind == BlockKind::kPlanePoint && group_count <= kMostFolded);
  // Coordinates in the drawing: e_c = M^-1 (e_uv - A e_patch); without a patch, e_patch = sum J_k e_uv_k and M = I.
  int column[2 * kMostFolded + 2];
  Mat2 part[kMostFolded + 1];
  int parts = 0;
  const int patch = patch_of(block.parent);
  Mat2 C = Mat2::Zero();
  if (patch >= 0) {
    const Block& at = state_.block[patch];
    const Patch p = at.patch();
    const Mat24 A = similarity_rows(block.uv() - p.t);
    part[0] = Mat2::Identity();
    part[1] = -A.leftCols<2>();
    part[2] = -A.rightCols<2>();
    const int first[3] = {block.first, at.first, at.first + 2};
    for (; parts < 3; ++parts) {
      column[2 * parts] = first[parts];
      column[2 * parts + 1] = first[parts] + 1;
    }
    const Scalar shrink = std::exp(-p.lambda);
    for (int i = 0; i < 3; ++i) part[i] *= shrink;
  } else {
    GroupFit fit;
    if (!fit.fit(state_, group, group_count)) return Scalar(1e12);
    const Mat24 A = similarity_rows(block.uv() - fit.middle);
    for (; parts < group_count; ++parts) {
      const Block& other = state_.block[group[parts]];
      part[parts] = -(A * fit.by_point(other.uv()));
      if (group[parts] == slot) part[parts] += Mat2::Identity();
      column[2 * parts] = other.first;
      column[2 * parts + 1] = other.first + 1;
    }
  }
  for (int i = 0; i < parts; ++i) {
    Mat2 PJ = Mat2::Zero();  // rows of part i times P J^T
    for (int j = 0; j < parts; ++j) {
      Mat2 P_ij;
      for (int a = 0; a < 2; ++a)
        for (int b = 0; b < 2; ++b) P_ij(a, b) = P_(column[2 * i + a], column[2 * j + b]);
      PJ += P_ij * part[j].transpose();
    }
    C += part[i] * PJ;
  }
  return largest_eigenvalue(C);
}

/// A patch about the middle of a group of plane points, that moves as they do.
int Filter::add_patch(int plane, const int* group, int count) {
  GroupFit fit;
  if (room() < 4 || !fit.fit(state_, group, count)) return -1;
  const int slot = take_slot(BlockKind::kPatch, 4);
  if (slot < 0) return -1;
  SparseRows J;
  J.rows = 4;
  J.segments = 0;
  Scalar noise[16] = {};
  // More points than segments: J P point by point, summed up in W_.
  const int n = state_.dim;
  std::memset(W_, 0, 4 * sizeof(Scalar) * static_cast<std::size_t>(ld_));
  for (int k = 0; k < count; ++k) {
    const Block& point = state_.block[group[k]];
    J.segments = 1;
    J.segment[0] = {point.first, 2};
    put<4, 2>(J.h, 2, 0, fit.by_point(point.uv()));
    kernels_->gather(P_, J, W_ + 4 * ld_, ld_);
    for (int i = 0; i < 4 * ld_; ++i) W_[i] += W_[4 * ld_ + i];
  }
  for (int k = 0; k < count; ++k) {
    const Block& point = state_.block[group[k]];
    const Eigen::Matrix<Scalar, 4, 2> J_k = fit.by_point(point.uv());
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j)
        for (int c = 0; c < 2; ++c) noise[4 * i + j] += W_[i * ld_ + point.first + c] * J_k(j, c);
  }
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < i; ++j) noise[4 * i + j] = noise[4 * j + i] = (noise[4 * i + j] + noise[4 * j + i]) / Scalar(2);
  // A patch is a function of its points: a hair of noise of its own keeps P positive definite.
  constexpr Scalar kOwn = Scalar(1e-10);
  for (int i = 0; i < 4; ++i) noise[5 * i] += kOwn * noise[5 * i];
  J.segments = 0;
  kernels_->augment(P_, J, noise);
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < n; ++j) P_.set(n + i, j, W_[i * ld_ + j]);
  state_.dim = P_.n;
  Block& block = state_.block[slot];
  state_.adopt(plane, slot);
  block.set_patch({fit.middle, Scalar(0), Scalar(0)});
  return slot;
}

bool Filter::fix(const int* slots, int count, FixForm form, const int* group, int group_count) {
  PF_ASSERT(count <= kMostFolded && 2 * count <= max_rows_ && max_rows_ >= 8);
  const int plane = state_.block[slots[0]].parent;
  int patch = patch_of(plane);
  if (patch < 0) patch = add_patch(plane, group, group_count);
  if (patch < 0) return false;
  const Block& at = state_.block[patch];
  const Patch p = at.patch();
  const Mat2 M_inverse = p.linear().inverse();
  // c = M^-1 (uv - t),  e_c = M^-1 (e_uv - A e_patch): the new rows in W_, and what they are among each other in S_.
  SparseRows J[kMostFolded];
  for (int i = 0; i < count; ++i) {
    const Block& block = state_.block[slots[i]];
    PF_ASSERT(block.kind == BlockKind::kPlanePoint && block.parent == plane);
    const Mat24 by_patch = -(M_inverse * similarity_rows(block.uv() - p.t));
    J[i].rows = 2;
    J[i].segments = 2;
    J[i].segment[0] = {at.first, 4};
    J[i].segment[1] = {block.first, 2};
    put<2, 4>(J[i].h, 6, 0, by_patch);
    put<2, 2>(J[i].h, 6, 4, M_inverse);
  }
  if (form != FixForm::kErrorFree) {
    kernels_->gather_many(P_, J, count, W_, ld_);
    kernels_->project(W_, 2 * count, ld_, J, count, S_, lds_);
  }
  int gone = 0;
  for (int i = 0; i < count; ++i) {
    Block& block = state_.block[slots[i]];
    state_.leave_parent(slots[i]);
    state_.adopt(patch, slots[i]);
    block.kind = BlockKind::kPatchPoint;
    block.set_uv(M_inverse * (block.uv() - p.t));
    list_gone(block.first, block.size, &gone);
    if (form == FixForm::kConsider) continue;
    block.set_inside(form == FixForm::kInflate ? innovation_block(i, i) : Mat2(Mat2::Zero()));
    block.size = 0;
    block.first = -1;
  }
  if (form == FixForm::kConsider)
    hold(slots, count, gone);
  else
    close_gaps(gone);
  return true;
}

/// The rows of patch points, new in W_ and S_ and listed where they were, go to the end of the held range.
void Filter::hold(const int* slots, int count, int gone) {
  const int n = state_.dim, at = state_.held_end(), size = 2 * count;
  for (int j = 0, stays = 0, g = 0; j < n; ++j) {  // where each row goes; -1: is one of those
    if (g < gone && j >= gone_[g].first + gone_[g].size) ++g;
    if (g < gone && j >= gone_[g].first)
      order_[j] = -1;
    else
      order_[j] = stays < at ? stays++ : size + stays++;
  }
  open_gap(P_, at, size, gone_, gone);
  for (int s = 0; s < state_.slots; ++s) {
    Block& block = state_.block[s];
    if (block.size > 0 && block.first >= at && order_[block.first] >= 0)
      block.first = static_cast<std::int16_t>(order_[block.first]);
  }
  for (int k = 0; k < count; ++k) state_.block[slots[k]].first = static_cast<std::int16_t>(at + 2 * k);
  for (int r = 0; r < size; ++r) {
    for (int j = 0; j < n; ++j)
      if (order_[j] >= 0) P_.set(at + r, order_[j], W_[r * ld_ + j]);
    for (int c = 0; c <= r; ++c) P_.set(at + r, at + c, S_[r * lds_ + c]);
  }
  state_.held_dim += size;
  state_.dim = P_.n;
}

bool Filter::release(int slot) {
  Block& block = state_.block[slot];
  PF_ASSERT(block.kind == BlockKind::kPatchPoint);
  if (room() < 2) return false;
  Block& patch = state_.block[block.parent];
  Mat2 J_turn, M;
  const Vec2 uv = patch_to_plane(patch.patch(), block.uv(), &J_turn, &M);
  SparseRows J;
  J.rows = 2;
  J.segments = block.size > 0 ? 2 : 1;
  J.segment[0] = {patch.first, 4};
  J.segment[1] = {block.first, 2};
  const int columns = block.size > 0 ? 6 : 4;
  put<2, 2>(J.h, columns, 0, Mat2::Identity());
  put<2, 2>(J.h, columns, 2, J_turn);
  Scalar raw[4] = {};
  if (block.size > 0) {
    put<2, 2>(J.h, columns, 4, M);
  } else {
    const Mat2 noise = M * block.inside() * M.transpose();
    put<2, 2>(raw, 2, 0, noise);
  }
  int gone = 0;
  const Segment old = {block.first, block.size};
  augment_block(&block, 2, J, raw);
  state_.leave_parent(slot);
  state_.adopt(patch.parent, slot);
  block.kind = BlockKind::kPlanePoint;
  block.set_uv(uv);
  if (old.size > 0) list_gone(old.first, old.size, &gone);
  close_gaps(gone);
  remove(nullptr, 0);  // a patch that nothing hangs on any more
  return true;
}

}  // namespace pf
