#include <cstring>

#include "filter/filter.h"
#include "filter/plane_from_camera.h"
#include "model/kinds.h"

/// Planes in the state: begun, points folded into them and out of them, moved to another frame.

namespace pf {

int Filter::add_plane(const PlaneFit& fit, const int* slots, int count, Scalar roughness) {
  if (state_.planes >= state_.max_planes || blocks_.max_rows() < 6) return -1;
  const int slot = take_slot(BlockKind::kPlane);
  if (slot < 0) return -1;
  Mat3 noise = Mat3::Zero();
  for (int k = 0; k < count; ++k) {
    PF_ASSERT(state_.block[slots[k]].kind == BlockKind::kPoint);
    const Vec3 rough = roughness * (fit_plane_jacobian(fit, state_.block[slots[k]].xyz()) * fit.frame.R_WP.col(2));
    noise += rough * rough.transpose();
  }
  Scalar raw[9];
  put<3, 3>(raw, 3, 0, noise);
  RowsOf<3, 3, 1> J;
  J.parts = 1;
  const auto by_point = [&](int k) {
    J.part[0] = Part::of(slots[k], 0, 3);
    put<3, 3>(J.h, 3, 0, fit_plane_jacobian(fit, state_.block[slots[k]].xyz()));
    return J.view();
  };
  blocks_.augment_dense(slot, 3, count, by_point, raw, Scalar(0));

  place_plane(slot, fit.frame, roughness_);
  return slot;
}

/// Puts a new plane's block at a = b = h = 0 of its frame.
void Filter::place_plane(int slot, const PlaneFrame& frame, Scalar roughness) {
  Block& block = state_.block[slot];
  block.set_xyz(Vec3::Zero());
  block.frame = -1;
  for (int f = 0; f < state_.max_planes && block.frame < 0; ++f) {
    bool free = true;
    for (int s = 0; s < state_.slots; ++s)
      if (s != slot && is_plane(state_.block[s].kind) && state_.block[s].frame == f) free = false;
    if (free) block.frame = static_cast<std::int16_t>(f);
  }
  PF_ASSERT(block.frame >= 0);
  state_.plane_frame[block.frame] = frame;
  state_.plane_roughness[block.frame] = roughness;
  ++state_.planes;
}

/// d = n . p - d_W of a place, and its row over plane and place.
void Filter::predict_distance(int plane, const Place& at, DistanceMeasurement* out) const {
  const Block& block = state_.block[plane];
  Mat13 J_x, J_p;
  out->predicted(0) = plane_distance(state_.frame_of(block), block.xyz(), at.o, &J_x, &J_p);
  out->measured(0) = Scalar(0);
  out->H.parts = 1;
  out->H.part[0] = Part::of(plane, 0, 3);
  for (int i = 0; i < 3; ++i) out->H.h[i] = J_x(i);
  int column = 0;
  for (int p = 0; p < at.parts; ++p) {
    Scalar h[Place::kMaxColumns];
    for (int i = 0; i < at.part[p].size; ++i) h[i] = J_p.transpose().dot(at.J_o.col(column++));
    add_part(&out->H, at.part[p], h);
  }
}

bool Filter::distance(int plane, int slot, Scalar* d, Scalar* variance) const {
  Place at;
  if (!find_point(state_, slot, &at)) return false;
  DistanceMeasurement z;
  predict_distance(plane, at, &z);
  *d = z.predicted(0);
  *variance = variance_of(z.H);
  return true;
}

Scalar Filter::plane_variance(int plane, const Vec3& p_W) const {
  const Block& block = state_.block[plane];
  Mat13 J_x;
  plane_distance(state_.frame_of(block), block.xyz(), p_W, &J_x);
  RowsOf<1, 3, 1> J;
  J.parts = 1;
  J.part[0] = Part::of(plane, 0, 3);
  put<1, 3>(J.h, 3, 0, J_x);
  return variance_of(J);
}

/// What a distance neglects as it is linear in the plane's slant (a, b) and in the place (u, v) of a point along the plane: a u + b v.
Scalar Filter::bend_of_distance(int plane, int slot, const ScaleRow& l) const {
  if (state_.block[slot].kind != BlockKind::kPoint) return Scalar(0);
  const Mat3& R_WP = state_.frame_of(state_.block[plane]).R_WP;
  const Mat3 C = relative_covariance(slot, l);
  Scalar sum = 0;
  for (int k = 0; k < 2; ++k) sum += block_variance(plane, k) * R_WP.col(k).dot(C * R_WP.col(k));
  return sum;
}

void Filter::begin_distances(int plane, const int* slots, int count, Scalar noise, DistanceMeasurement* z) {
  PF_ASSERT(count <= kMaxFolded);
  // The distance scales with the world: H N_s = d. With l, the row that picks the log scale, d - d l . e has none of it.
  ScaleRow l;
  if (!keep_gauge_ || !scale_row(&l)) l.parts = 0;
  Measurement view[kMaxFolded];
  for (int i = 0; i < count; ++i) {
    Place at;
    find_point(state_, slots[i], &at);
    predict_distance(plane, at, &z[i]);
    const Scalar d = z[i].predicted(0);
    for (int p = 0, from = 0; p < l.parts; ++p) {
      Scalar h[12];
      for (int k = 0; k < l.part[p].size; ++k) h[k] = -d * l.h[from++];
      add_part(&z[i].H, l.part[p], h);
    }
    z[i].set_noise(DistanceMeasurement::Matrix::Constant(noise + bend_of_distance(plane, slots[i], l)));
    view[i] = z[i].view();
  }
  begin_update(view, count);
}

/// Takes in a distance of zero of the chosen ones together.
bool Filter::condition_on(int plane, const int* slots, int count, Scalar noise, const unsigned char* folded) {
  int chosen[kMaxFolded];
  int m = 0;
  for (int i = 0; i < count; ++i)
    if (folded[i] != 0) chosen[m++] = slots[i];
  if (m == 0) return true;
  DistanceMeasurement z[kMaxFolded];
  Measurement view[kMaxFolded];
  begin_distances(plane, chosen, m, noise, z);
  for (int i = 0; i < m; ++i) view[i] = z[i].view();
  return finish_update(view, m, nullptr, nullptr);
}

int Filter::fold(int plane, const int* slots, int count, const FoldRule& rule, unsigned char* folded) {
  PF_ASSERT(count <= kMaxFolded && 2 * count <= blocks_.max_rows());
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
  if (rule.condition && !condition_on(plane, slots, count, noise, folded)) {
    std::memset(folded, 0, static_cast<std::size_t>(count));
    return 0;
  }
  // The transform: coordinates in the plane, all in one pass. The point goes from p to q in the plane, and rotates with the world from
  // then on as q does:  (u, v) = axes p,  J_uv_theta = axes ([p]x - [q]x). The paper's fold knows nothing of that.
  const PlaneFrame& frame = state_.frame_of(state_.block[plane]);
  const Mat23 axes = frame.R_WP.transpose().topRows<2>();
  RowsOf<2, Place::kMaxColumns + 3, Place::kMaxParts + 1> J[kMaxFolded];
  Rows rows[kMaxFolded];
  int moved[kMaxFolded];
  int done = 0;
  for (int i = 0; i < count; ++i) {
    if (folded[i] == 0) continue;
    Place at;
    find_point(state_, slots[i], &at);
    const Vec2 uv = plane_coordinates(frame, at.o);
    const Vec3 dropped = plane_point(frame, state_.block[plane].xyz(), uv) - at.o;
    const Mat23 J_theta = keep_gauge_ && rule.condition ? Mat23(-axes * hat(dropped)) : Mat23(Mat23::Zero());
    const int columns = at.columns + 3;
    J[done].parts = at.parts + 1;
    J[done].part[0] = Part::body(Body::kTheta, 3);
    put<2, 3>(J[done].h, columns, 0, J_theta);
    for (int part = 0; part < at.parts; ++part) J[done].part[part + 1] = at.part[part];
    for (int c = 0; c < at.columns; ++c) put<2, 1>(J[done].h, columns, 3 + c, Vec2(axes * at.J_o.col(c)));
    rows[done] = J[done];
    moved[done++] = slots[i];
    Block& block = state_.block[slots[i]];
    state_.leave_parent(slots[i]);
    state_.adopt(plane, slots[i]);
    block.kind = BlockKind::kPlanePoint;
    block.size = 2;
    block.set_uv(uv);
  }
  if (done > 0) blocks_.transform(moved, rows, done);
  return done;
}

bool Filter::unfold(int slot, Scalar sigma_normal) {
  Block& block = state_.block[slot];
  PF_ASSERT(is_planar(block.kind));
  if (room() < 3) return false;
  Place at;
  find_point(state_, slot, &at);
  const Block& plane = state_.block[at.plane];
  Vec3 normal;
  Scalar d;
  plane_normal(state_.frame_of(plane), plane.xyz(), &normal, &d);
  Mat3 noise = sigma_normal * sigma_normal * normal * normal.transpose();
  if (!at.has_rows) noise += at.J_own * block.inside() * at.J_own.transpose();
  Scalar raw[9];
  put<3, 3>(raw, 3, 0, noise);
  blocks_.augment(slot, at.rows<3>(Mat3::Identity()), raw);
  state_.leave_parent(slot);
  block.kind = BlockKind::kPoint;
  block.size = 3;
  block.set_xyz(at.o);
  remove(nullptr, 0);  // a point group without children
  return true;
}

void Filter::inflate(int plane, const Mat3& Q) {
  Scalar raw[9];
  put<3, 3>(raw, 3, 0, Q);
  blocks_.inflate(Part::of(plane, 0, 3), raw);
}

bool Filter::reanchor(int plane, const PlaneFrame& frame) {
  Block& block = state_.block[plane];
  const PlaneFrame old = state_.frame_of(block);
  Vec3 x;
  Mat3 J_x;
  if (group_of(plane) >= 0 || !reframe_plane(old, block.xyz(), frame, &x, &J_x)) return false;
  // The points first: their new coordinates depend on the plane as it was. So it is in the last of the passes.
  const Mat23 axes = frame.R_WP.transpose().topRows<2>();
  RowsOf<2, 5, 2> J[kMaxFolded];
  RowsOf<3, 3, 1> J_plane;
  Rows rows[kMaxFolded];
  int moved[kMaxFolded];
  int count = 0;
  const int max_moved = blocks_.max_rows() / 3 < kMaxFolded ? blocks_.max_rows() / 3 : kMaxFolded;
  const auto move = [&] {
    for (int i = 0; i < count; ++i) {
      if (moved[i] == plane) {
        J_plane.parts = 1;
        J_plane.part[0] = Part::of(plane, 0, 3);
        put<3, 3>(J_plane.h, 3, 0, J_x);
        rows[i] = J_plane;
        continue;
      }
      Block& at = state_.block[moved[i]];
      Mat3 J_p_x;
      Mat32 J_p_uv;
      const Vec3 p_W = plane_point(old, block.xyz(), at.uv(), &J_p_x, &J_p_uv);
      J[i].parts = 2;
      J[i].part[0] = Part::of(plane, 0, 3);
      J[i].part[1] = Part::of(moved[i], 0, 2);
      const Mat23 by_plane = axes * J_p_x;
      const Mat2 by_uv = axes * J_p_uv;
      put<2, 3>(J[i].h, 5, 0, by_plane);
      put<2, 2>(J[i].h, 5, 3, by_uv);
      rows[i] = J[i];
      at.set_uv(plane_coordinates(frame, p_W));
    }
    blocks_.transform(moved, rows, count);
    count = 0;
  };
  for (int s = 0; s < state_.slots; ++s) {
    if (state_.block[s].kind != BlockKind::kPlanePoint || state_.block[s].parent != plane) continue;
    if (count + 1 == max_moved) move();
    moved[count++] = s;
  }
  moved[count++] = plane;
  move();
  block.set_xyz(x);
  state_.plane_frame[block.frame] = frame;
  return true;
}

void Filter::forget_through(int plane, const Vec3& sigma) {
  blocks_.inflate_through(plane_from_camera(state_, plane), sigma);
}

}  // namespace pf
