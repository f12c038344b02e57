#pragma once

#include <cstddef>

#include "base/arena.h"
#include "covariance/kernels.h"
#include "filter/motion.h"
#include "filter/state.h"
#include "geometry/camera.h"

/// The extended Kalman filter: five verbs (predict, augment, transform, remove, update) over one block table and one triangle.
/// Gee 2007, section 3.1.

namespace pf {

/// What one feature's pixel says: prediction, residual and the few columns that it touches (at most body, anchor, feature).
struct Observation {
  static constexpr int kMaxSegments = 3;
  static constexpr int kMaxColumns = 12;

  int slot = -1;
  int segments = 0;
  Segment segment[kMaxSegments];
  Scalar h[2 * kMaxColumns];         ///< row-major 2 x columns
  Vec2 predicted = Vec2::Zero();     ///< [px]
  Vec2 measured = Vec2::Zero();      ///< [px]
  Mat2 noise = Mat2::Identity();     ///< covariance of the measurement [px^2]
  Mat2 second_order = Mat2::Zero();  ///< what the linearisation leaves out [px^2]; belongs into noise
};

struct FilterCapacity {
  int state_dim;
  int features;
  int observations;  ///< in one update
};

class Filter {
 public:
  bool layout(Arena& arena, const FilterCapacity& capacity);
  void init(const Kernels* kernels, int body_dim, bool keep_gauge);

  const State& state() const { return state_; }
  const Triangle& covariance() const { return P_; }
  Body& body() { return state_.body; }

  /// The whole body block becomes known as covariance says (body_dim x body_dim, row-major). Only while the map is empty.
  void set_body(const Body& body, const Scalar* covariance);

  // --- predict
  /// Known change of the velocities, in camera axes:  v_W += R_WC dv,  w_C += dw;  e_v -= [R_WC dv]x theta.
  void steer(const Vec3& dv_C, const Vec3& dw_C);
  /// Velocities and their errors shrink by a factor of 0 .. 1, which turns and scales with the world as they do.
  void damp(Scalar factor);
  void predict(const Transition& transition);

  // --- augment; -1 where there is no room
  int add_anchor();
  int add_inverse_depth(int anchor, const Vec3& ray_C, const Mat32& J_ray_z, const Mat2& noise_px, Scalar rho,
                        Scalar sigma_rho);
  int add_point(const Vec3& p_W, const Mat3& covariance);

  // --- transform
  /// Inverse depth to 3-D point, in its slot; the anchor goes when nothing needs it.
  void convert_to_point(int slot);

  // --- remove; anchors that nothing needs any more go with them, all in one pass
  void remove(const int* slots, int count);

  // --- update
  /// Prediction, Jacobian and columns of a feature's pixel; false when it does not project.
  bool predict_pixel(const Camera& camera, int slot, Observation* out) const;
  /// H P H^T of one observation, without noise.
  Mat2 innovation(const Observation& observation) const;
  /// Gathers H P and S = H P H^T (without noise) of `count` observations. Then innovation_block is valid until the state changes.
  void begin_update(const Observation* observations, int count);
  Mat2 innovation_block(int i, int j) const;
  /// Takes the chosen observations in (keep[i] != 0; null takes all) and moves the state. False, with the state and P unchanged, when
  /// S cannot be factored or the step is no number. *nis gets the normalised innovation squared.
  bool finish_update(const Observation* observations, int count, const unsigned char* keep, Scalar* nis);

  Mat3 covariance3(int slot) const;
  /// A feature's place in W; an inverse depth that is not positive counts as far away.
  Vec3 point(int slot) const;
  Scalar variance(int row) const { return P_(row, row); }
  /// Rows that are still free.
  int room() const { return most_rows_ - state_.dim; }

  // --- soundness: finite, bounded, and no variance below zero
  bool body_is_sound() const;
  /// Likewise for a block and the anchor that it hangs on.
  bool block_is_sound(int slot) const;

 private:
  void sparse(const Observation& observation, SparseRows* rows) const;
  int take_slot(BlockKind kind, int size);
  bool scale_row(SparseRows* row) const;
  bool is_step(const Scalar* dx) const;

  const Kernels* kernels_ = nullptr;
  bool keep_gauge_ = true;
  State state_;
  Triangle P_;
  int most_rows_ = 0;  ///< of the state; P_ has room for a few more
  int max_rows_ = 0;   ///< rows of one update
  int ld_ = 0;
  int lds_ = 0;
  Scalar* W_ = nullptr;   ///< max_rows x ld: H P, then L^-1 H P
  Scalar* S_ = nullptr;   ///< max_rows x lds
  Scalar* U_ = nullptr;   ///< 4 x ld: gauge rows after minus before
  Scalar* G_ = nullptr;   ///< 4 x ld
  Scalar* dx_ = nullptr;  ///< ld
  Scalar* y_ = nullptr;   ///< max_rows
  Segment* gone_ = nullptr;
};

}  // namespace pf
