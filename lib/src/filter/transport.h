#pragma once

#include "filter/block_filter.h"
#include "filter/gauge_prior.h"
#include "model/state.h"

namespace pf {

/// Keeps the covariance consistent with what a bare camera cannot observe, when an update moves the state (lib/docs/theory/gauge.md).
///
///   M = I + U^T V takes the gauge directions N at x- to those at x+:  U = N(x+) - N(x-),  V N(x-) = I
///   rows of V:  rotation E_theta,  log scale l,  translation E_p + [p]x E_theta - p l         (body p at x-)
///   with P1 = P - W^T W:   M P1 M^T = P1 + U^T G + G^T U,   G = V P1 + (V P1 V^T) U / 2
///
/// Translations are the same at every x but for planes, whose distance moves by n . t: without planes they need no rows. With them
/// their rows of U come last, zero but for the heights of planes, and the downdate spends nothing on what is zero.
class Transport {
 public:
  bool layout(Arena& arena, int ld);
  void init();

  /// Before the state moves, with the row that picks the log scale (no parts: none): U = -N(x-), raw rows of V P in G.
  void begin(const State& state, const BlockFilter& blocks, const ScaleRow& l);
  /// After it has moved, while the gain is there: U and G as above.
  void finish(const State& state, const BlockFilter& blocks);
  /// The log scale's direction N_s at the state as it is (ld numbers), until the next update.
  const Scalar* scale_direction(const State& state, const BlockFilter& blocks);
  /// For P + N V N^T, over the directions of gauge.h: U = N and G = V N / 2, by rows().
  void spread(const State& state, const BlockFilter& blocks, const GaugePrior::Matrix& V);
  /// No transport in this update.
  void skip() { rows_ = 0; }

  const Scalar* U() const { return U_; }
  const Scalar* G() const { return G_; }
  int rows() const { return rows_; }

 private:
  void add_considered(const BlockFilter& blocks);

  static constexpr int kMaxRows = 7;

  int ld_ = 0;
  int rows_ = 0;
  Scalar* U_ = nullptr;  ///< kMaxRows x ld: gauge rows after minus before; rotation, scale, translation
  Scalar* G_ = nullptr;  ///< kMaxRows x ld
  ScaleRow l_;
  Vec3 p_before_ = Vec3::Zero();
};

}  // namespace pf
