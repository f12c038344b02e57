#pragma once

#include "model/kind.h"

namespace pf::model {

/// Bearing and inverse depth from its parent anchor, see InverseDepth. value: q_b (w x y z), rho
///
///   d = rho (o - c) + b          dd: o rho I,  (e_1, e_2) B,  e_rho o - c
struct InverseDepthPoint : Kind {
  static constexpr BlockKind kKind = BlockKind::kInverseDepth;
  static constexpr KindInfo kInfo{3, 5, FeatureForm::kInverseDepth, ScaleSource::kOwnRow, false, false, false};
  static constexpr bool kHasPlace = true;

  static void retract(Block* block, const Scalar* e);
  static void place(const State& state, int slot, Place* out);
  static Vec3 point(const State& state, const Block& block);
  /// Translation and scale leave the bearing; rotation about B_2, -B_1; rho goes with the inverse scale.
  template <typename Rows>
  static void rows(const Block& block, Rows* N) {
    const InverseDepth d = block.inverse_depth();
    const Mat3 R = d.q_b.toRotationMatrix();
    N->template block<1, 3>(0, 3) = R.col(1).transpose();
    N->template block<1, 3>(1, 3) = -R.col(0).transpose();
    (*N)(2, 6) = -d.rho;
  }
  static void gauge(const State&, const Block& block, GaugeRows* N);
  static void add_gauge(const State&, const Block& block, int first, const GaugeSum& sum);
  /// -e_rho / rho
  static bool scale_row(const State& state, int slot, ScaleRow* row);
};

}  // namespace pf::model
