#pragma once

#include <cstdint>

#include "base/eigen.h"
#include "covariance/kernels.h"

/// What the filter estimates: a table of blocks. This is the only place that knows where a block lies in the covariance.

namespace pf {

/// Pose and velocity of the camera. Error, in this order: theta (3), p (3), and with the constant-velocity model v (3), w (3).
///
///   R_true = Exp(theta) R_WC,   p_true = p + e_p,   v_true = v + e_v,   w_true = w + e_w
struct Body {
  static constexpr int kTheta = 0, kPosition = 3, kVelocity = 6, kRate = 9;
  static constexpr int kPoseDim = 6, kMaxDim = 12;

  Quat q_WC = Quat::Identity();
  Vec3 p_W = Vec3::Zero();  ///< [m]
  Vec3 v_W = Vec3::Zero();  ///< [m/s]
  Vec3 w_C = Vec3::Zero();  ///< [rad/s]
};

enum class BlockKind : std::uint8_t {
  kNone = 0,
  kAnchor = 1,        ///< where the camera was when inverse-depth points began: o_W, additive
  kPoint = 2,         ///< p_W, additive
  kInverseDepth = 3,  ///< bearing from its parent anchor and inverse depth, see InverseDepth
};

/// Bearing b = R_b e_z from the anchor, with the tangent basis B = R_b [e_x e_y]; inverse depth rho along it [1/m].
///
///   p_W = o_W + b / rho,   error (e_1, e_2, e_rho):  b_true = Exp(B_2 e_1 - B_1 e_2) b = b + B e,   rho_true = rho + e_rho
///
/// No angles, so no pole; the basis is carried along with b.
struct InverseDepth {
  Quat q_b;
  Scalar rho;
};

struct Block {
  BlockKind kind = BlockKind::kNone;
  std::int16_t first = -1;  ///< first row in the covariance
  std::int16_t size = 0;
  std::int16_t parent = -1;   ///< slot of the anchor
  std::int16_t children = 0;  ///< of an anchor: inverse-depth points that need it
  Scalar value[5] = {};       ///< anchor, point: x y z. inverse depth: q_b (w x y z), rho

  Vec3 xyz() const { return Vec3(value[0], value[1], value[2]); }
  void set_xyz(const Vec3& p) {
    value[0] = p.x();
    value[1] = p.y();
    value[2] = p.z();
  }
  InverseDepth inverse_depth() const { return {Quat(value[0], value[1], value[2], value[3]), value[4]}; }
  void set_inverse_depth(const InverseDepth& d) {
    value[0] = d.q_b.w();
    value[1] = d.q_b.x();
    value[2] = d.q_b.y();
    value[3] = d.q_b.z();
    value[4] = d.rho;
  }
};

/// Blocks live in slots that do not move; rows of the covariance follow the order of `first`.
struct State {
  Body body;
  int body_dim = Body::kMaxDim;
  Block* block = nullptr;  ///< slots
  int slots = 0;
  int dim = 0;  ///< rows in use, body included

  /// A free slot, or -1.
  int find_free() const {
    for (int i = 0; i < slots; ++i)
      if (block[i].kind == BlockKind::kNone) return i;
    return -1;
  }
};

/// x <- x [+] dx: every block moves by its part of dx (dim entries).
void apply_error(State& state, const Scalar* dx);

/// Adds sign times the unobservable directions of a bare camera at x, one row per direction, leading dimension ld:
///
///   rotation (3 x dim, into N_R): theta I;  p, o, f: -[.]x;  v: -[v]x;  bearing: B_2^T, -B_1^T;  w, rho: 0
///   scale    (1 x dim, into N_s): p, v, o, f: as they are;  rho: -rho;  theta, w, bearing: 0
///
/// Translation is the same at every x (p, o, f: I), so it needs no rows.
void add_gauge_rows(const State& state, Scalar sign, Scalar* N_R, Scalar* N_s, int ld);

}  // namespace pf
