#pragma once

#include "filter/observe/inverse_depth.h"
#include "filter/rows.h"
#include "filter/state.h"

namespace pf {

/// Place of a feature of any kind in W, and its Jacobian over the blocks that it hangs on.
///
///   point f;   inverse depth o + b / rho;   plane point p(x, u, v);   patch point p(x, t + M c)       src Gee 2007 (9)
///
/// J is 3 x columns over the parts in their order.
struct WorldPoint {
  static constexpr int kMaxParts = 3;
  static constexpr int kMaxColumns = 9;

  Vec3 p_W = Vec3::Zero();
  int parts = 0;
  int columns = 0;
  Part part[kMaxParts];
  Eigen::Matrix<Scalar, 3, kMaxColumns> J;

  template <int Size>
  void append(int block, const Eigen::Matrix<Scalar, 3, Size>& J_block) {
    part[parts++] = Part::of(block, 0, Size);
    J.block<3, Size>(0, columns) = J_block;
    columns += Size;
  }
};

/// What (u, v) = t + M c depends on: t by I, phi and lambda by the columns of J_uv_turn, c by M.
inline Vec2 patch_to_plane(const Patch& patch, const Vec2& c, Mat2* J_uv_turn, Mat2* M) {
  *M = patch.linear();
  const Vec2 d = *M * c;
  J_uv_turn->col(0) = Vec2(-d.y(), d.x());
  J_uv_turn->col(1) = d;
  return patch.t + d;
}

/// False for an inverse depth that is not positive. J_p_c (may be null) gets the Jacobian by a patch point's own coordinates, which
/// are in J only where they have rows.
inline bool world_point(const State& state, int slot, WorldPoint* out, Mat32* J_p_c = nullptr) {
  const Block& block = state.block[slot];
  out->parts = out->columns = 0;
  switch (block.kind) {
    case BlockKind::kPoint:
      out->p_W = block.xyz();
      out->append<3>(slot, Mat3::Identity());
      return true;
    case BlockKind::kInverseDepth: {
      const InverseDepth d = block.inverse_depth();
      if (!(d.rho > Scalar(1e-6))) return false;
      const Block& anchor = state.block[block.parent];
      Mat3 J_feature;
      out->p_W = inverse_depth_to_point(anchor.xyz(), d, &J_feature);
      out->append<3>(block.parent, Mat3::Identity());
      out->append<3>(slot, J_feature);
      return true;
    }
    case BlockKind::kPlanePoint: {
      const Block& plane = state.block[block.parent];
      Mat3 J_x;
      Mat32 J_uv;
      out->p_W = plane_point(state.frame_of(plane), plane.xyz(), block.uv(), &J_x, &J_uv);
      out->append<3>(block.parent, J_x);
      out->append<2>(slot, J_uv);
      return true;
    }
    case BlockKind::kPatchPoint: {
      const Block& patch = state.block[block.parent];
      const Block& plane = state.block[patch.parent];
      Mat2 J_turn, M;
      const Vec2 uv = patch_to_plane(patch.patch(), block.uv(), &J_turn, &M);
      Mat3 J_x;
      Mat32 J_uv;
      out->p_W = plane_point(state.frame_of(plane), plane.xyz(), uv, &J_x, &J_uv);
      out->append<3>(patch.parent, J_x);
      Eigen::Matrix<Scalar, 3, 4> J_patch;
      J_patch.leftCols<2>() = J_uv;
      J_patch.rightCols<2>() = J_uv * J_turn;
      out->append<4>(block.parent, J_patch);
      const Mat32 J_c = J_uv * M;
      if (block.size > 0) out->append<2>(slot, J_c);
      if (J_p_c != nullptr) *J_p_c = J_c;
      return true;
    }
    default:
      return false;
  }
}

}  // namespace pf
