#include "bundle/normal_equations.h"

#include <algorithm>
#include <cmath>

#include "bundle/pose_rows.h"
#include "bundle/tuning.h"
#include "geometry/small_cholesky.h"

namespace pf {

bool NormalEquations::layout(Arena& arena, int max_free_poses, int max_points, int max_planes, int max_lens_rows) {
  ld = 3 * max_planes + max_lens_rows + 6 * max_free_poses;
  plane_part = max_planes > 0 ? 3 : 0;
  w_ld = plane_part + max_lens_rows + 6 * max_free_poses;
  const std::size_t points = static_cast<std::size_t>(max_points), most_columns = static_cast<std::size_t>(ld);
  H = arena.take<Scalar>(most_columns * most_columns);
  b = arena.take<Scalar>(most_columns);
  W = arena.take<Scalar>(points * static_cast<std::size_t>(w_ld));
  D = arena.take<Scalar>(points);
  g = arena.take<Scalar>(points);
  return arena.ok();
}

void NormalEquations::begin(int planes, int lens_rows, int poses) {
  plane_columns = 3 * planes;
  lens_columns = lens_rows;
  columns = pose_column(poses);
  PF_ASSERT(columns <= ld);
}

void NormalEquations::clear() {
  for (int a = 0; a < columns; ++a) {
    std::fill(H + a * ld, H + a * ld + columns, Scalar(0));
    b[a] = Scalar(0);
  }
}

void NormalEquations::clear_point(int point) {
  Scalar* w = plane_row(point);
  std::fill(w, w + plane_part + columns - plane_columns, Scalar(0));
}

void NormalEquations::eliminate(int point, Scalar information, Scalar gradient, Scalar damping, std::uint32_t seen_by,
                                int plane) {
  using namespace tuning::adjust;
  D[point] =
      information < kMinInformation ? information + damping * kMinInformation : information * (Scalar(1) + damping);
  g[point] = gradient;
  if (D[point] > kNoInformation)
    subtract(point, seen_by, plane);
  else
    D[point] = Scalar(0);
}

/// In the blocks that w touches alone.
void NormalEquations::subtract(int point, std::uint32_t seen_by, int plane) {
  const Scalar D_point = D[point], g_point = g[point];
  const Scalar* w_plane = plane_row(point);
  const bool on_plane = plane >= 0;
  const int plane_column = on_plane ? 3 * plane : 0;
  Scalar t[6];
  if (on_plane) {
    for (int a = 0; a < 3; ++a) t[a] = w_plane[a] / D_point;
    blocks::subtract_small<3, 3>(t, w_plane, H + plane_column * (ld + 1), ld);
    for (int a = 0; a < 3; ++a) b[plane_column + a] -= t[a] * g_point;
  }
  const Scalar* w_lens = lens_row(point);
  for (int a = 0; a < lens_columns; ++a) {
    const Scalar share = w_lens[a] / D_point;
    Scalar* row = H + (plane_columns + a) * ld;
    for (int f = 0; f < 3 && on_plane; ++f) row[plane_column + f] -= share * w_plane[f];
    for (int k = 0; k <= a; ++k) row[plane_columns + k] -= share * w_lens[k];
    b[plane_columns + a] -= share * g_point;
  }
  for (int f = 0; seen_by >> f != 0; ++f) {
    if ((seen_by >> f & 1) == 0) continue;
    const int column = pose_column(f);
    const Scalar* w = pose_row(point, f);
    for (int a = 0; a < 6; ++a) t[a] = w[a] / D_point;
    if (on_plane) blocks::subtract_small<6, 3>(t, w_plane, H + column * ld + plane_column, ld);
    for (int a = 0; a < 6 && lens_columns > 0; ++a)
      for (int k = 0; k < lens_columns; ++k) H[(column + a) * ld + plane_columns + k] -= t[a] * w_lens[k];
    for (int k = 0; k <= f; ++k)
      if ((seen_by >> k & 1) != 0) blocks::subtract_block(t, pose_row(point, k), H + column * ld + pose_column(k), ld);
    for (int a = 0; a < 6; ++a) b[column + a] -= t[a] * g_point;
  }
}

bool NormalEquations::solve(Scalar damping) {
  for (int a = 0; a < columns; ++a)
    H[a * ld + a] += damping * std::abs(H[a * ld + a]) + tuning::adjust::kRegularisation;
  if (!factor()) return false;
  solve_factored();
  return true;
}

Scalar NormalEquations::point_step(int point, int plane) const {
  if (!(D[point] > Scalar(0))) return Scalar(0);
  Scalar sum = g[point];
  const Scalar* w = plane_row(point);
  for (int a = 0; a < 3 && plane >= 0; ++a) sum -= w[a] * b[3 * plane + a];
  w += plane_part;
  const Scalar* dx = b + plane_columns;
  for (int a = 0; a < columns - plane_columns; ++a) sum -= w[a] * dx[a];
  return sum / D[point];
}

bool NormalEquations::factor() { return factor_cholesky(H, columns, ld); }

void NormalEquations::solve_factored() const { solve_cholesky(H, columns, ld, b); }

void NormalEquations::solve_unit(int column) const {
  std::fill(b, b + columns, Scalar(0));
  b[column] = Scalar(1);
  solve_factored();
}

void NormalEquations::spread(int point, int plane, Scalar factor) const {
  std::fill(b, b + columns, Scalar(0));
  const Scalar* w = plane_row(point);
  for (int a = 0; a < 3 && plane >= 0; ++a) b[3 * plane + a] = factor * w[a];
  for (int a = 0; a < columns - plane_columns; ++a) b[plane_columns + a] = factor * w[plane_part + a];
}

Scalar NormalEquations::gather(int point, int plane) const {
  Scalar sum = 0;
  const Scalar* w = plane_row(point);
  for (int a = 0; a < 3 && plane >= 0; ++a) sum += w[a] * b[3 * plane + a];
  for (int a = 0; a < columns - plane_columns; ++a) sum += w[plane_part + a] * b[plane_columns + a];
  return sum;
}

}  // namespace pf
