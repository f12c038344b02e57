#pragma once

#include <cmath>
#include <cstdint>

#include "base/eigen.h"
#include "geometry/plane.h"

/// What the filter estimates: kinds and values of blocks, and how they hang on each other. Where their rows lie, BlockFilter knows.

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
  kPlane = 4,         ///< (a, b, h) about its constant frame, additive, see geometry/plane.h
  kPlanePoint = 5,    ///< folded: coordinates (u, v) in the frame of its parent plane, additive
  kPatch = 6,         ///< where a drawing lies on its parent plane, see Patch
  kPatchPoint =
      7,  ///< fixed: coordinates in its parent patch, additive; considered (Schmidt), or without rows of its own
};

/// Planar features hang on a plane, directly or through a patch.
inline bool is_planar(BlockKind kind) { return kind == BlockKind::kPlanePoint || kind == BlockKind::kPatchPoint; }

/// Bearing b = R_b e_z from the anchor, with the tangent basis B = R_b [e_x e_y]; inverse depth rho along it [1/m].
///
///   p_W = o_W + b / rho,   error (e_1, e_2, e_rho):  b_true = Exp(B_2 e_1 - B_1 e_2) b = b + B e,   rho_true = rho + e_rho
///
/// No angles, so no pole; the basis is carried along with b.
struct InverseDepth {
  Quat q_b;
  Scalar rho;
};

/// A drawing on a plane that shifts, turns and grows as one: what is fixed in it moves with it, and only with it.
///
///   (u, v) = t + exp(lambda) Rot(phi) c            c: coordinates in the patch
///   error (e_t, e_phi, e_lambda), additive
///
/// Coordinates in a patch know nothing of the drift that the whole plane shares, so they can be known well.
struct Patch {
  Vec2 t;
  Scalar phi, lambda;

  Mat2 linear() const {
    const Scalar c = std::exp(lambda) * std::cos(phi), s = std::exp(lambda) * std::sin(phi);
    Mat2 M;
    M << c, -s, s, c;
    return M;
  }
};

struct Block {
  static constexpr int kMaxRows = 4;

  BlockKind kind = BlockKind::kNone;
  std::int16_t size = 0;      ///< rows that it has: those of its kind, or none
  std::int16_t parent = -1;   ///< slot of the anchor, plane or patch
  std::int16_t children = 0;  ///< blocks that have this one as parent
  std::int16_t owner = -1;    ///< entry of the map's table that this block belongs to; orders the children of a parent
  std::int16_t first_child = -1;   ///< slots, by ascending owner; of equal owners the one that came first
  std::int16_t next_sibling = -1;  ///< of the same parent
  std::int16_t frame = -1;         ///< of a plane: index into State::plane_frame
  /// anchor, point: x y z. inverse depth: q_b (w x y z), rho. plane: a b h. plane point: u v. patch: t, phi, lambda.
  /// patch point: c, and where it has no rows its covariance (xx, xy, yy)
  Scalar value[5] = {};

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
  Vec2 uv() const { return Vec2(value[0], value[1]); }
  void set_uv(const Vec2& uv) {
    value[0] = uv.x();
    value[1] = uv.y();
  }
  /// Covariance of a patch point's coordinates that have no rows [m^2, in the patch].
  Mat2 inside() const {
    Mat2 C;
    C << value[2], value[3], value[3], value[4];
    return C;
  }
  void set_inside(const Mat2& C) {
    value[2] = C(0, 0);
    value[3] = C(0, 1);
    value[4] = C(1, 1);
  }
  Patch patch() const { return {Vec2(value[0], value[1]), value[2], value[3]}; }
  void set_patch(const Patch& p) {
    value[0] = p.t.x();
    value[1] = p.t.y();
    value[2] = p.phi;
    value[3] = p.lambda;
  }
};

class BlockFilter;

/// Blocks live in slots that do not move.
struct State {
  Body body;
  int body_dim = Body::kMaxDim;
  Block* block = nullptr;  ///< slots
  int slots = 0;
  PlaneFrame* plane_frame = nullptr;
  int max_planes = 0;
  int planes = 0;

  const PlaneFrame& frame_of(const Block& plane) const { return plane_frame[plane.frame]; }

  /// A free slot, or -1.
  int find_free() const {
    for (int i = 0; i < slots; ++i)
      if (block[i].kind == BlockKind::kNone) return i;
    return -1;
  }
  /// Slot of the plane that a planar feature or a patch hangs on.
  int plane_of(int slot) const {
    while (block[slot].kind != BlockKind::kPlane) slot = block[slot].parent;
    return slot;
  }

  /// Makes a block without a parent a child of this one.
  void adopt(int parent, int child);
  /// Takes a block out of its parent's list; nothing where it has no parent.
  void leave_parent(int child);
  /// Says which entry of the map's table a block belongs to.
  void set_owner(int slot, int owner);

  /// Calls f(slot) for the features that hang on a plane, directly or through its patch, by ascending owner. f may remove the block
  /// that it is given, unfold it or release it.
  template <typename F>
  void for_each_planar(int plane, F&& f) const {
    int direct = block[plane].first_child, fixed = -1;
    for (int c = direct; c >= 0; c = block[c].next_sibling)
      if (block[c].kind == BlockKind::kPatch) fixed = block[c].first_child;
    while (direct >= 0 || fixed >= 0) {
      const bool take_direct = fixed < 0 || (direct >= 0 && block[direct].owner <= block[fixed].owner);
      int& cursor = take_direct ? direct : fixed;
      const int slot = cursor;
      cursor = block[slot].next_sibling;
      if (is_planar(block[slot].kind)) f(slot);
    }
  }
};

/// x <- x [+] dx: every block moves by its rows of dx.
void apply_error(State& state, const BlockFilter& blocks, const Scalar* dx);

using GaugeRows = Eigen::Matrix<Scalar, Block::kMaxRows, 7>;

/// How a block's error changes when the whole world is shifted (columns 0-2), turned (3-5) and grows by a factor of exp(s) (6).
/// The directions that a bare camera cannot observe. Rows beyond the block's size are zero.
///
///   p, o, f:  I, -[.]x, as they are       bearing:  0, (B_2, -B_1)^T, 0        rho:  0, 0, -rho
///   plane:  geometry/plane.h              (u, v):  first rows of R_WP^T (I, -[p]x, p), p the point on the plane
///   patch:  what (u, v) -> k + M (u, v) does to t, and to phi and lambda the part of M that turns and grows;
///   in the patch:  the shear that is left
GaugeRows gauge_rows(const State& state, const Block& block);

/// Adds sign times these directions at x over the whole state, one row per direction, leading dimension ld. Of the body: theta I;
/// p, v turn; p shifts; p, v scale. N_T may be null: shifts are the same at every x but for planes.
void add_gauge_rows(const State& state, const BlockFilter& blocks, Scalar sign, Scalar* N_T, Scalar* N_R, Scalar* N_s,
                    int ld);

}  // namespace pf
