#include "filter/scale_row.h"

#include <algorithm>
#include <cmath>

#include "base/limits.h"
#include "filter/tuning.h"
#include "geometry/plane.h"
#include "model/kinds.h"

/// The row that picks the world's log scale out of an error, and what is known against it.

namespace pf {
namespace {

constexpr Scalar kMinDistance2 = Scalar(1e-12);  ///< [m^2] between two points whose distance is a length

/// Adds a place's part of a row: d^T J.
void add_place(const Place& at, const Vec3& d, ScaleRow* row) {
  int column = 0;
  for (int p = 0; p < at.parts; ++p) {
    Scalar h[Place::kMaxColumns];
    for (int i = 0; i < at.part[p].size; ++i) h[i] = d.dot(at.J_o.col(column++));
    add_part(row, at.part[p], h);
  }
}

/// The point that is farthest from another one.
struct FarthestPoint {
  Vec3 from;
  int slot = -1;
  Scalar distance2 = kMinDistance2;

  void look_at(int t, const Vec3& p) {
    const Scalar d2 = (p - from).squaredNorm();
    if (!(d2 > distance2)) return;
    distance2 = d2;
    slot = t;
  }

  /// The row of the log distance. False where no point is away from this one.
  bool add_length(const State& state, int from_slot, ScaleRow* row) const {
    if (slot < 0) return false;
    Place a, b;
    find_point(state, from_slot, &a);
    find_point(state, slot, &b);
    const Vec3 d = (a.o - b.o) / distance2;
    add_place(a, d, row);
    add_place(b, -d, row);
    return true;
  }
};

/// The log of the camera's distance from a plane. False where the block is none, or the camera is on it.
bool add_distance_from_plane(const State& state, int slot, ScaleRow* row) {
  const Block& plane = state.block[slot];
  row->parts = 0;
  if (plane.kind != BlockKind::kPlane) return false;
  Mat13 J_x, J_p;
  const Scalar distance = plane_distance(state.frame_of(plane), plane.xyz(), state.body.p_W, &J_x, &J_p);
  if (!(distance * distance > kMinDistance2)) return false;
  J_x /= distance;
  J_p /= distance;
  add_part(row, Part::body(Body::kPosition, 3), J_p.data());
  add_part(row, Part::of(slot, 0, 3), J_x.data());
  return true;
}

/// The best known of the first `most` lengths. length(slot, row): whether that block gives one.
template <typename Length>
bool best_length(const Filter& filter, int most, ScaleRow* row, Length length) {
  const State& state = filter.state();
  row->parts = 0;
  if (!gauge::contains(state.unobservable, gauge::kScale)) return false;
  Scalar best = Scalar(0);
  bool found = false;
  int tried = 0;
  for (int s = 0; s < state.slots && tried < most; ++s) {
    ScaleRow candidate;
    if (!length(s, &candidate)) continue;
    ++tried;
    const Scalar variance = filter.blocks().variance(candidate);
    if (found && variance >= best) continue;
    best = variance;
    found = true;
    *row = candidate;
  }
  return found;
}

}  // namespace

Mat3 Filter::relative_covariance(int slot, const ScaleRow& l) const {
  const Block& block = state_.block[slot];
  PF_ASSERT(block.kind == BlockKind::kPoint);
  const Vec3 d = block.xyz() - state_.body.p_W;
  RowsOf<1, 18, 6> row[3];
  for (int axis = 0; axis < 3; ++axis) {
    Scalar one[3] = {}, less[3] = {}, scaled[12];
    one[axis] = Scalar(1);
    less[axis] = Scalar(-1);
    add_part(&row[axis], Part::of(slot, 0, 3), one);
    add_part(&row[axis], Part::body(Body::kPosition, 3), less);
    for (int p = 0, c = 0; p < l.parts; ++p) {
      for (int i = 0; i < l.part[p].size; ++i) scaled[i] = -d[axis] * l.h[c++];
      add_part(&row[axis], l.part[p], scaled);
    }
  }
  const int columns = row[0].columns();
  Scalar h[3 * 18];
  for (int axis = 0; axis < 3; ++axis) std::copy(row[axis].h, row[axis].h + columns, h + axis * columns);
  return blocks_.covariance_of<3>({3, row[0].parts, row[0].part, h});
}

Scalar Filter::relative_sigma_rho(int slot, const ScaleRow& l) const {
  const Block& block = state_.block[slot];
  PF_ASSERT(block.kind == BlockKind::kInverseDepth);
  const Scalar rho = block.inverse_depth().rho;
  for (int p = 0; p < l.parts; ++p)  // the row depends on this point itself, which cannot measure its own scale
    if (l.part[p].block == slot) return std::sqrt(block_variance(slot, 2));
  RowsOf<1, 13, 5> row;  // those of l, and rho
  for (int p = 0, c = 0; p < l.parts; ++p) {
    Scalar scaled[12];
    for (int i = 0; i < l.part[p].size; ++i) scaled[i] = rho * l.h[c++];
    add_part(&row, l.part[p], scaled);
  }
  const Scalar one = Scalar(1);
  add_part(&row, Part::of(slot, 2, 1), &one);
  return std::sqrt(blocks_.variance(row));
}

/// A log length that one block gives: a point group's lambda, a log inverse depth, or the distance between a point and the one that is
/// farthest from it. It annihilates translations and rotations, and grows by s when the world is scaled by exp(s). It touches no held
/// rows. *places: how many points are listed in place_; -1: not yet.
bool Filter::scale_candidate(int slot, int* places, ScaleRow* row) const {
  const Block& block = state_.block[slot];
  const ScaleSource source = info(block.kind).scale;
  row->parts = 0;
  if (source == ScaleSource::kNone) return false;
  if (source == ScaleSource::kOwnRow) {
    bool has = false;
    visit(block.kind, [&](auto kind) { has = decltype(kind)::scale_row(state_, slot, row); });
    return has;
  }
  if (*places < 0) {
    *places = 0;
    for (int t = 0; t < state_.slots; ++t) {
      if (info(state_.block[t].kind).scale != ScaleSource::kDistance) continue;
      place_slot_[*places] = t;
      place_[(*places)++] = point(t);
    }
  }
  FarthestPoint farthest = {point(slot)};
  for (int t = 0; t < *places; ++t) farthest.look_at(place_slot_[t], place_[t]);
  return farthest.add_length(state_, slot, row);
}

/// The best known of a few log lengths; where no point gives one, as with patches of walls alone, of all distances from planes. There is
/// none where the scale is observable.
bool Filter::scale_row(ScaleRow* row) const {
  int places = -1;
  const auto of_points = [&](int slot, ScaleRow* length) { return scale_candidate(slot, &places, length); };
  const auto of_planes = [&](int slot, ScaleRow* length) { return add_distance_from_plane(state_, slot, length); };
  return best_length(*this, tuning::scale::kMaxTried, row, of_points) || best_length(*this, kMaxPlanes, row, of_planes);
}

bool find_scale_row(const Filter& filter, ScaleRow* row) {
  const State& state = filter.state();
  return best_length(filter, tuning::scale::kMaxTried, row, [&](int slot, ScaleRow* length) {
    const ScaleSource source = info(state.block[slot].kind).scale;
    length->parts = 0;
    bool has = false;
    if (source == ScaleSource::kOwnRow) {
      visit(state.block[slot].kind, [&](auto kind) { has = decltype(kind)::scale_row(state, slot, length); });
    } else if (source == ScaleSource::kDistance) {
      FarthestPoint farthest = {filter.point(slot)};
      for (int t = 0; t < state.slots; ++t)
        if (info(state.block[t].kind).scale == ScaleSource::kDistance) farthest.look_at(t, filter.point(t));
      has = farthest.add_length(state, slot, length);
    }
    return has;
  });
}

}  // namespace pf
