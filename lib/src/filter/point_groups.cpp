#include <cmath>

#include "filter/filter.h"
#include "filter/tuning.h"
#include "model/kinds.h"

/// Fixed points. What is known well of a point on a plane is not where it is, for that carries the whole map's drift, but how it lies
/// among the other points of its plane. So these are fixed in a point group, which moves as one and stays in the state.

namespace pf {
namespace {

using namespace tuning::point_group;

constexpr Scalar kUnknown = Scalar(1e12);  ///< variance where the members span no area

using Mat24 = Eigen::Matrix<Scalar, 2, 4>;

/// d(u, v) / d(t, phi, lambda) for a point at uv, about a group at t: [I, J d, d], d = uv - t.
Mat24 similarity_rows(const Vec2& d) {
  Mat24 A = Mat24::Zero();
  A(0, 0) = A(1, 1) = Scalar(1);
  A(0, 2) = -d.y();
  A(1, 2) = d.x();
  A(0, 3) = d.x();
  A(1, 3) = d.y();
  return A;
}

/// How a point group follows its members: the affine map that fits their errors best has the translation e_t and the linear part
/// sum e_uv (D^-1 d)^T, D = sum d d^T, d = uv - middle; the group takes the rotation (phi) and the scale (lambda) of it:
///
///   e_phi = sum (e_v g_u - e_u g_v) / 2,   e_lambda = sum (e_u g_u + e_v g_v) / 2,   g = D^-1 d
///
/// An affine map and not a similarity fit, so that moving the world does exactly the same to the group.
struct GroupFit {
  Vec2 middle = Vec2::Zero();
  Mat2 D_inverse = Mat2::Zero();
  int count = 0;

  /// False where the points do not span an area.
  bool fit(const State& state, const int* members, int num_members) {
    count = num_members;
    middle.setZero();
    for (int i = 0; i < count; ++i) middle += state.block[members[i]].uv() / static_cast<Scalar>(count);
    Mat2 D = Mat2::Zero();
    for (int i = 0; i < count; ++i) {
      const Vec2 d = state.block[members[i]].uv() - middle;
      D += d * d.transpose();
    }
    const Scalar trace = D(0, 0) + D(1, 1), det = D(0, 0) * D(1, 1) - D(0, 1) * D(0, 1);
    if (count < 4 || !(det > kMinSpread * trace * trace)) return false;
    D_inverse << D(1, 1) / det, -D(0, 1) / det, -D(0, 1) / det, D(0, 0) / det;
    return true;
  }
  /// 4x2: what one point's coordinates do to the group.
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

int Filter::group_of(int plane) const {
  for (int s = 0; s < state_.slots; ++s)
    if (state_.block[s].kind == BlockKind::kPointGroup && state_.block[s].parent == plane) return s;
  return -1;
}

Scalar Filter::variance_in_group(int slot, const int* members, int num_members) const {
  const Block& block = state_.block[slot];
  PF_ASSERT(block.kind == BlockKind::kPlanePoint && num_members <= kMaxFolded);
  // Coordinates in the group: e_c = M^-1 (e_uv - A e_group); where there is none yet, e_group = sum J_k e_uv_k and M = I.
  const int group = group_of(block.parent);
  if (group >= 0) {
    const PointGroup p = state_.block[group].group();
    const Scalar shrink = std::exp(-p.lambda);
    RowsOf<2, 6, 2> J;
    J.parts = 2;
    J.part[0] = Part::of(slot, 0, 2);
    J.part[1] = Part::of(group, 0, 4);
    put<2, 2>(J.h, 6, 0, shrink * Mat2::Identity());
    put<2, 4>(J.h, 6, 2, -shrink * similarity_rows(block.uv() - p.t));
    return largest_eigenvalue(blocks_.covariance_of<2>(J));
  }
  GroupFit fit;
  if (!fit.fit(state_, members, num_members)) return kUnknown;
  const Mat24 A = similarity_rows(block.uv() - fit.middle);
  RowsOf<2, 2 * kMaxFolded, kMaxFolded> J;
  J.parts = num_members;
  for (int k = 0; k < num_members; ++k) {
    Mat2 by_point = -(A * fit.by_point(state_.block[members[k]].uv()));
    if (members[k] == slot) by_point += Mat2::Identity();
    J.part[k] = Part::of(members[k], 0, 2);
    put<2, 2>(J.h, 2 * num_members, 2 * k, by_point);
  }
  return largest_eigenvalue(blocks_.covariance_of<2>(J));
}

/// Begins a point group about the middle of plane points, that moves as they do.
int Filter::add_group(int plane, const int* members, int count) {
  GroupFit fit;
  if (room() < 4 || !fit.fit(state_, members, count)) return -1;
  const int slot = take_slot(BlockKind::kPointGroup);
  if (slot < 0) return -1;
  Scalar noise[16] = {};
  RowsOf<4, 2, 1> J;
  J.parts = 1;
  const auto by_point = [&](int k) {
    J.part[0] = Part::of(members[k], 0, 2);
    put<4, 2>(J.h, 2, 0, fit.by_point(state_.block[members[k]].uv()));
    return J.view();
  };
  // A group is a function of its members: a little noise of its own keeps P positive definite.
  blocks_.augment_dense(slot, 4, count, by_point, noise, kOwnNoise);
  Block& block = state_.block[slot];
  state_.adopt(plane, slot);
  block.set_group({fit.middle, Scalar(0), Scalar(0)});
  return slot;
}

bool Filter::fix(const int* slots, int count, FixForm form, const int* members, int num_members) {
  PF_ASSERT(count <= kMaxFolded && 2 * count <= blocks_.max_rows() && blocks_.max_rows() >= 8);
  const int plane = state_.block[slots[0]].parent;
  int group = group_of(plane);
  if (group < 0) group = add_group(plane, members, num_members);
  if (group < 0) return false;
  const Block& at = state_.block[group];
  const PointGroup p = at.group();
  const Mat2 M_inverse = p.linear().inverse();
  // c = M^-1 (uv - t),  e_c = M^-1 (e_uv - A e_group)
  RowsOf<2, 6, 2> J[kMaxFolded];
  Measurement rows[kMaxFolded];
  for (int i = 0; i < count; ++i) {
    const Block& block = state_.block[slots[i]];
    PF_ASSERT(block.kind == BlockKind::kPlanePoint && block.parent == plane);
    const Mat24 by_group = -(M_inverse * similarity_rows(block.uv() - p.t));
    J[i].parts = 2;
    J[i].part[0] = Part::of(group, 0, 4);
    J[i].part[1] = Part::of(slots[i], 0, 2);
    put<2, 4>(J[i].h, 6, 0, by_group);
    put<2, 2>(J[i].h, 6, 4, M_inverse);
    rows[i].H = J[i];
  }
  if (form != FixForm::kErrorFree) blocks_.project(rows, count);
  for (int i = 0; i < count; ++i) {
    Block& block = state_.block[slots[i]];
    state_.leave_parent(slots[i]);
    state_.adopt(group, slots[i]);
    block.kind = BlockKind::kGroupedPoint;
    block.set_uv(M_inverse * (block.uv() - p.t));
    if (form == FixForm::kConsider) continue;
    block.set_inside(form == FixForm::kInflate ? blocks_.innovation2(i, i) : Mat2(Mat2::Zero()));
    block.size = 0;
  }
  if (form == FixForm::kConsider)
    blocks_.hold(slots, count);
  else
    blocks_.remove(slots, count);
  return true;
}

bool Filter::release(int slot) {
  Block& block = state_.block[slot];
  PF_ASSERT(block.kind == BlockKind::kGroupedPoint);
  if (room() < 2) return false;
  Block& group = state_.block[block.parent];
  Mat2 J_rotation, M;
  const Vec2 uv = model::group_to_plane(group.group(), block.uv(), &J_rotation, &M);
  RowsOf<2, 6, 2> J;
  J.parts = block.size > 0 ? 2 : 1;
  J.part[0] = Part::of(block.parent, 0, 4);
  J.part[1] = Part::of(slot, 0, 2);
  const int columns = block.size > 0 ? 6 : 4;
  put<2, 2>(J.h, columns, 0, Mat2::Identity());
  put<2, 2>(J.h, columns, 2, J_rotation);
  Scalar raw[4] = {};
  if (block.size > 0) {
    put<2, 2>(J.h, columns, 4, M);
  } else {
    const Mat2 noise = M * block.inside() * M.transpose();
    put<2, 2>(raw, 2, 0, noise);
  }
  blocks_.augment(slot, J, raw);
  state_.leave_parent(slot);
  state_.adopt(group.parent, slot);
  block.size = 2;
  block.kind = BlockKind::kPlanePoint;
  block.set_uv(uv);
  remove(nullptr, 0);  // a point group without children
  return true;
}

}  // namespace pf
