#pragma once

#include "model/kind.h"

namespace pf::model {

/// A copy of the camera at the time of a frame: the pose of a mark, or the one in which patches and points begin. value: q_WC (w x y z),
/// p_WC
///
///   R_true = Exp(theta) R_WC,   p_true = p_WC + e_p         as the body's pose
struct ReferenceCamera : Kind {
  static constexpr BlockKind kKind = BlockKind::kReferenceCamera;
  static constexpr KindInfo kInfo{6, 7, FeatureForm::kNone, ScaleSource::kNone, false, true, false};

  static Quat q_WC(const Block& block) { return Quat(block.value[0], block.value[1], block.value[2], block.value[3]); }
  static Vec3 p_WC(const Block& block) { return Vec3(block.value[4], block.value[5], block.value[6]); }
  static void set(Block* block, const Quat& q_WC, const Vec3& p_WC) {
    block->value[0] = q_WC.w();
    for (int i = 0; i < 3; ++i) {
      block->value[1 + i] = q_WC.vec()(i);
      block->value[4 + i] = p_WC(i);
    }
  }

  static void retract(Block* block, const Scalar* e);
  template <typename Rows>
  static void rows(const Block& block, Rows* N) {
    GaugeRowsOf<3> position;
    put_place<3>(Mat3::Identity(), p_WC(block), &position);
    N->template block<3, 3>(0, gauge::kRotation).setIdentity();
    N->template middleRows<3>(3) = position;
  }
  static void gauge(const State&, const Block& block, GaugeRows* N);
  static void add_gauge(const State&, const Block& block, int first, const GaugeSum& sum);
};

}  // namespace pf::model
