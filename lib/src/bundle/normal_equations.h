#pragma once

#include <cstdint>

#include "base/arena.h"
#include "base/eigen.h"

namespace pf {

/// Normal equations of a bundle, from which the points are eliminated one by one:
///
///   | H_pp  W  | dx   |b|      S = H_pp - W D⁻¹ Wᵀ
///   | Wᵀ    D  | drho |g|      S dx = b - W D⁻¹ g,   drho = D⁻¹ (g - Wᵀ dx)
///
/// x holds (a, b, h) of each free plane, the lens, and then (theta, p) of each free pose. Planes and poses are numbered among the free
/// ones. A plane index of -1 means no free plane.
struct NormalEquations {
  int ld = 0;             ///< 3 max_planes + max_lens_rows + 6 max_free_poses
  int w_ld = 0;           ///< plane_part + max_lens_rows + 6 max_free_poses
  int plane_part = 0;     ///< 3 if there may be planes, else 0
  int plane_columns = 0;  ///< 3 times the free planes of this bundle
  int lens_columns = 0;   ///< rows of this bundle's lens
  int columns = 0;        ///< both, and 6 times its free poses
  Scalar* H = nullptr;    ///< ld square: H_pp, then S, then its factor
  Scalar* b = nullptr;    ///< ld
  Scalar* W = nullptr;    ///< max_points x w_ld: a row for each point: its plane, the lens, each free pose
  Scalar* D = nullptr;    ///< max_points, damped; zero where nothing is known of a point
  Scalar* g = nullptr;    ///< max_points

  bool layout(Arena& arena, int max_free_poses, int max_points, int max_planes, int max_lens_rows);
  /// How many of each are free in this bundle.
  void begin(int planes, int lens_rows, int poses);
  /// Of nothing yet: H_pp and b.
  void clear();
  /// The same of a point's row of W.
  void clear_point(int point);
  /// Has D and g of a point, and eliminates it unless nothing is known of it. seen_by: bit f, W has entries for free pose f.
  ///
  ///   H -= w wᵀ / D,   b -= w g / D,   D damped:  D (1 + damping), where D is below one: D + damping
  void eliminate(int point, Scalar information, Scalar gradient, Scalar damping, std::uint32_t seen_by, int plane);
  /// b becomes dx with S_ii += damping |S_ii| + 1e-9. False when S is not positive definite.
  bool solve(Scalar damping);
  /// drho of a point, after solve().
  Scalar point_step(int point, int plane) const;

  /// H becomes its factor, which the functions below need. False when S is not positive definite.
  bool factor();
  /// b becomes the column of S⁻¹.
  void solve_unit(int column) const;
  /// b becomes S⁻¹ b.
  void solve_factored() const;
  /// b becomes factor w of a point.
  void spread(int point, int plane, Scalar factor) const;
  /// w . b of a point.
  Scalar gather(int point, int plane) const;

  int pose_column(int free_pose) const { return plane_columns + lens_columns + 6 * free_pose; }
  Scalar* plane_row(int point) const { return W + point * w_ld; }
  Scalar* lens_row(int point) const { return plane_row(point) + plane_part; }
  Scalar* pose_row(int point, int free_pose) const { return lens_row(point) + lens_columns + 6 * free_pose; }

 private:
  void subtract(int point, std::uint32_t seen_by, int plane);
};

}  // namespace pf
