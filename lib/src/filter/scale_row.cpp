#include <algorithm>
#include <cmath>

#include "filter/filter.h"
#include "filter/model/kinds.h"
#include "filter/tuning.h"

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
  for (int p = 0; p < l.parts; ++p)  // the row hangs on this very point: it cannot be its own measure
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
  const Vec3 here = point(slot);
  int far = -1;
  Scalar far2 = kMinDistance2;
  for (int t = 0; t < *places; ++t) {
    const Scalar d2 = (place_[t] - here).squaredNorm();
    if (d2 > far2) {
      far2 = d2;
      far = t;
    }
  }
  if (far < 0) return false;
  Place from, to;
  find_point(state_, slot, &from);
  find_point(state_, place_slot_[far], &to);
  const Vec3 d = (from.o - to.o) / far2;
  add_place(from, d, row);
  add_place(to, -d, row);
  return true;
}

/// The best known of a few log lengths. There is none where the scale is observable.
bool Filter::scale_row(ScaleRow* row) const {
  row->parts = 0;
  if (!gauge::contains(state_.unobservable, gauge::kScale)) return false;
  int places = -1;
  Scalar best = Scalar(0);
  bool found = false;
  int tried = 0;
  for (int s = 0; s < state_.slots && tried < tuning::scale::kMaxTried; ++s) {
    ScaleRow candidate;
    if (!scale_candidate(s, &places, &candidate)) continue;
    ++tried;
    const Scalar variance = blocks_.variance(candidate);
    if (found && variance >= best) continue;
    best = variance;
    found = true;
    *row = candidate;
  }
  return found;
}

}  // namespace pf
