#pragma once

#include "model/anchor.h"
#include "model/grouped_point.h"
#include "model/inverse_depth.h"
#include "model/patch_corners.h"
#include "model/plane.h"
#include "model/plane_apart.h"
#include "model/plane_point.h"
#include "model/point.h"
#include "model/point_group.h"
#include "model/reference_camera.h"

namespace pf {

/// All kinds. A new one needs its file, its line here and its name in BlockKind.
#define PF_KINDS(X)           \
  X(model::Anchor)            \
  X(model::Point)             \
  X(model::InverseDepthPoint) \
  X(model::Plane)             \
  X(model::PlanePoint)        \
  X(model::Group)             \
  X(model::GroupedPoint)      \
  X(model::ReferenceCamera)   \
  X(model::PatchCorners)      \
  X(model::PlaneApart)

/// Calls f with an object of the kind's type; nothing for BlockKind without one.
template <typename F>
inline void visit(BlockKind kind, F&& f) {
  switch (kind) {
#define PF_CASE(Type) \
  case Type::kKind:   \
    f(Type());        \
    break;
    PF_KINDS(PF_CASE)
#undef PF_CASE
    case BlockKind::kNone:
      break;
  }
}

/// Listed in the order of BlockKind, which kKindInfo is indexed with.
constexpr bool kinds_are_in_order() {
  int next = 1;
  bool in_order = true;
#define PF_IN_ORDER(Type) in_order = in_order && static_cast<int>(Type::kKind) == next++;
  PF_KINDS(PF_IN_ORDER)
#undef PF_IN_ORDER
  return in_order && next == kBlockKinds;
}
static_assert(kinds_are_in_order());

#define PF_FITS(Type) static_assert(Type::kInfo.rows <= Block::kMaxRows && Type::kInfo.values <= Block::kMaxValues);
PF_KINDS(PF_FITS)
#undef PF_FITS

/// Where a block is; false where its kind has no place, or an inverse depth is not positive.
inline bool find_place(const State& state, int slot, Place* out) {
  bool has = false;
  visit(state.block[slot].kind, [&](auto kind) {
    using K = decltype(kind);
    has = K::kHasPlace;
    if constexpr (K::kHasPlace) K::place(state, slot, out);
  });
  return has;
}

/// The same as a point of W.
inline bool find_point(const State& state, int slot, Place* out) {
  return find_place(state, slot, out) && out->resolve();
}

}  // namespace pf
