#pragma once

#include <cstring>

#include "base/eigen.h"

/// Blocks of normal equations, two numbers in one register.

namespace pf::blocks {

/// Two numbers in one register. What is computed with them is what single numbers would give, to the last bit.
typedef Scalar Pair __attribute__((vector_size(2 * sizeof(Scalar))));

inline Pair load(const Scalar* from) {
  Pair pair;
  std::memcpy(&pair, from, sizeof pair);
  return pair;
}
inline void store(Scalar* to, Pair pair) { std::memcpy(to, &pair, sizeof pair); }
inline Pair twice(Scalar v) { return Pair{v, v}; }

/// Columns of a 2x3 Jacobian.
struct Columns {
  Pair at[3];
};

/// Two rows of a Jacobian by (theta, p), two columns in one register.
struct PoseRows {
  Pair x[3], y[3];
};

/// [J [v]x, scale J]. -J gives the rows of the host with -scale.
inline PoseRows pose_rows(const Columns& J, const Vec3& v, Scalar scale) {
  const Pair c[6] = {J.at[1] * v.z() - J.at[2] * v.y(),
                     J.at[2] * v.x() - J.at[0] * v.z(),
                     J.at[0] * v.y() - J.at[1] * v.x(),
                     scale * J.at[0],
                     scale * J.at[1],
                     scale * J.at[2]};
  PoseRows rows;
  for (int k = 0; k < 3; ++k) {
    rows.x[k] = Pair{c[2 * k][0], c[2 * k + 1][0]};
    rows.y[k] = Pair{c[2 * k][1], c[2 * k + 1][1]};
  }
  return rows;
}

/// H += weight AᵀB in the first 2 kPairs columns of rows 2 k and 2 k + 1.
template <int kPairs>
inline void add_two_rows(const PoseRows& A, const PoseRows& B, Scalar weight, int k, Scalar* H, int ld) {
  for (int a = 0; a < 2; ++a) {
    const Pair x = twice(A.x[k][a]), y = twice(A.y[k][a]);
    Scalar* row = H + (2 * k + a) * ld;
    for (int e = 0; e < kPairs; ++e) store(row + 2 * e, load(row + 2 * e) + weight * (x * B.x[e] + y * B.y[e]));
  }
}

/// H += weight AᵀB, six by six.
inline void add_block(const PoseRows& A, const PoseRows& B, Scalar weight, Scalar* H, int ld) {
  add_two_rows<3>(A, B, weight, 0, H, ld);
  add_two_rows<3>(A, B, weight, 1, H, ld);
  add_two_rows<3>(A, B, weight, 2, H, ld);
}

/// H += weight JᵀJ: the lower triangle, and one number to the right of it in every other row.
inline void add_square(const PoseRows& J, Scalar weight, Scalar* H, int ld) {
  add_two_rows<1>(J, J, weight, 0, H, ld);
  add_two_rows<2>(J, J, weight, 1, H, ld);
  add_two_rows<3>(J, J, weight, 2, H, ld);
}

/// b += weight Jᵀr.
inline void add_column(const PoseRows& J, Scalar r_x, Scalar r_y, Scalar weight, Scalar* b) {
  for (int e = 0; e < 3; ++e) store(b + 2 * e, load(b + 2 * e) + weight * (J.x[e] * r_x + J.y[e] * r_y));
}

/// H += Jᵀ v, six rows in one column.
inline void add_lens_column(const PoseRows& J, const Vec2& v, Scalar* H, int ld) {
  for (int a = 0; a < 6; ++a, H += ld) *H += J.x[a / 2][a % 2] * v.x() + J.y[a / 2][a % 2] * v.y();
}

/// H -= t wᵀ.
inline void subtract_block(const Scalar (&t)[6], const Scalar* w, Scalar* H, int ld) {
  const Pair row[3] = {load(w), load(w + 2), load(w + 4)};
  for (int a = 0; a < 6; ++a, H += ld)
    for (int e = 0; e < 3; ++e) store(H + 2 * e, load(H + 2 * e) - t[a] * row[e]);
}
template <int kRows, int kColumns>
inline void subtract_small(const Scalar (&t)[6], const Scalar* w, Scalar* H, int ld) {
  Scalar row[kColumns];
  for (int e = 0; e < kColumns; ++e) row[e] = w[e];
  for (int a = 0; a < kRows; ++a, H += ld)
    for (int e = 0; e < kColumns; ++e) H[e] -= t[a] * row[e];
}

}  // namespace pf::blocks
