#pragma once

#include <cmath>
#include <cstdint>

#include "base/eigen.h"
#include "geometry/plane.h"
#include "model/rows.h"

/// A block of the state: its kind, its values, and the blocks that it depends on.

namespace pf {

/// Kinds of blocks; each has a file in this folder, and kinds.h lists them.
enum class BlockKind : std::uint8_t {
  kNone = 0,
  kAnchor = 1,
  kPoint = 2,
  kInverseDepth = 3,
  kPlane = 4,
  kPlanePoint = 5,
  kPointGroup = 6,
  kGroupedPoint = 7,
  kReferenceCamera = 8,
  kPatchCorners = 9,
  kPlaneApart = 10,
};
inline constexpr int kBlockKinds = 11;

/// Whether blocks of this kind have a plane's frame.
inline bool is_plane(BlockKind kind) { return kind == BlockKind::kPlane || kind == BlockKind::kPlaneApart; }

/// The kind of a feature for the caller of the library.
enum class FeatureForm : std::uint8_t { kNone, kPoint, kInverseDepth, kFolded, kFixed };

/// Where a kind's log length comes from, which picks the world's scale out of an error.
enum class ScaleSource : std::uint8_t {
  kNone,
  kOwnRow,   ///< its own: the kind has scale_row()
  kDistance  ///< the distance to another block of such a kind
};

/// Properties of a kind that the filter uses.
struct KindInfo {
  int rows = 0;    ///< in the covariance
  int values = 0;  ///< in Block::value
  FeatureForm form = FeatureForm::kNone;
  ScaleSource scale = ScaleSource::kNone;
  bool planar = false;          ///< depends on a plane, directly or through a point group
  bool dies_childless = false;  ///< is removed with its last child, unless it is pinned
  bool carries_points = false;  ///< not a feature, but rows that features share
};

/// Bearing b = R_b e_z from the anchor, with the tangent basis B = R_b [e_x e_y]; inverse depth rho along it [1/m].
///
///   p_W = o_W + b / rho,   error (e_1, e_2, e_rho):  b_true = Exp(B_2 e_1 - B_1 e_2) b = b + B e,   rho_true = rho + e_rho
///
/// No angles, so no pole; the basis rotates with b.
struct InverseDepth {
  Quat q_b;
  Scalar rho;
};

/// Points of a plane that are translated, rotated and scaled together: a point that is fixed in the group moves with the group only.
///
///   (u, v) = t + exp(lambda) Rot(phi) c            c: coordinates in the group
///   error (e_t, e_phi, e_lambda), additive
///
/// Coordinates in a group do not contain the drift that the whole plane shares, so they can become certain.
struct PointGroup {
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
  static constexpr int kMaxRows = 10;    ///< a lens has as many
  static constexpr int kMaxValues = 10;  ///< a reference camera has seven, a lens ten

  BlockKind kind = BlockKind::kNone;
  std::uint8_t pins = 0;     ///< uses from outside of the state, such as a mark; the block stays while there are any
  std::int16_t size = 0;     ///< its rows: those of its kind, or none
  std::int16_t parent = -1;  ///< slot of the block that its coordinates are in: an anchor, plane or point group
  std::int16_t second_parent = -1;  ///< slot of another block that its place depends on
  std::int16_t children = 0;        ///< blocks that have this one as a parent
  /// Entry of the map's table that this block belongs to; orders the children of a parent. Of a copy of the camera, which has neither: a
  /// number by which it differs from others that have had its slot.
  std::int16_t owner = -1;
  std::int16_t first_child = -1;     ///< slots, by ascending owner; of equal owners the one that came first
  std::int16_t next_sibling = -1;    ///< in the list of its parent
  std::int16_t next_of_second = -1;  ///< in the list of its second parent
  std::int16_t frame = -1;           ///< of a plane: index into State::plane_frame
  Scalar value[kMaxValues] = {};     ///< meaning: the kind's file

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
  /// Covariance of a grouped point's coordinates that have no rows [m^2, in the group].
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
  PointGroup group() const { return {Vec2(value[0], value[1]), value[2], value[3]}; }
  void set_group(const PointGroup& g) {
    value[0] = g.t.x();
    value[1] = g.t.y();
    value[2] = g.phi;
    value[3] = g.lambda;
  }
};

}  // namespace pf
