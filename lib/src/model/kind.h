#pragma once

#include "model/gauge.h"
#include "model/place.h"
#include "model/state.h"

namespace pf::model {

/// Defaults of a kind. A kind has kKind and kInfo, and replaces of these what it does otherwise:
///
///   retract    x [+] e of its values, e over its rows
///   add_gauge  its gauge rows over the whole state; planar kinds get theirs with their parent's
///   gauge      its gauge rows alone
///   place      where it is; only with kHasPlace
///   scale_row  the row that picks the log scale; only with ScaleSource::kOwnRow
struct Kind {
  static constexpr bool kHasPlace = false;
  static constexpr bool kSharesGauge = false;  ///< gauge rows of children are made of its own

  static void retract(Block* block, const Scalar* e) {
    for (int i = 0; i < block->size; ++i) block->value[i] += e[i];
  }
  static void place(const State&, int, Place*) {}
  static bool scale_row(const State&, int, ScaleRow*) { return false; }
};

}  // namespace pf::model
