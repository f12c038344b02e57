#include "slam/consensus.h"

#include <cmath>

namespace pf {
namespace {

Mat2 inverse2(const Mat2& S) {
  const Scalar det = S(0, 0) * S(1, 1) - S(0, 1) * S(1, 0);
  Mat2 inverse;
  inverse << S(1, 1), -S(0, 1), -S(1, 0), S(0, 0);
  return inverse / det;
}

}  // namespace

Scalar squared_distance(const Vec2& r, const Mat2& S) {
  const Scalar det = S(0, 0) * S(1, 1) - S(0, 1) * S(1, 0);
  if (!(det > Scalar(0)) || !(S(0, 0) > Scalar(0))) return Scalar(1e12);
  return (r.x() * (S(1, 1) * r.x() - S(0, 1) * r.y()) + r.y() * (S(0, 0) * r.y() - S(1, 0) * r.x())) / det;
}

bool is_covariance(const Mat2& S) {
  return std::isfinite(S(0, 0)) && std::isfinite(S(1, 1)) && S(0, 0) > Scalar(0) &&
         S(0, 0) * S(1, 1) - S(0, 1) * S(1, 0) > Scalar(0);
}

int find_inliers(const Filter& filter, const PixelMeasurement* observations, int count, Scalar gate,
                 unsigned char* keep) {
  int best = -1, best_inliers = 0;
  Scalar best_sum = 0;
  for (int pass = 0; pass < 2; ++pass) {
    for (int i = 0; i < count; ++i) {
      if (pass == 1 && i != best) continue;
      const Mat2 Sii = filter.innovation_block(i, i) + observations[i].R_gate;
      const Mat2 Sii_inverse = inverse2(Sii);
      const Vec2 ri = observations[i].measured - observations[i].predicted;
      const Vec2 a = Sii_inverse * ri;
      int inliers = 0;
      Scalar sum = 0;
      for (int j = 0; j < count; ++j) {
        bool is_inlier = true;
        if (j != i) {
          const Mat2 Sji = filter.innovation_block(j, i);
          const Vec2 r = observations[j].measured - observations[j].predicted - Sji * a;
          const Mat2 S = filter.innovation_block(j, j) + observations[j].R_gate - Sji * Sii_inverse * Sji.transpose();
          const Scalar d2 = squared_distance(r, S);
          is_inlier = d2 < gate;
          if (is_inlier) sum += d2;
        }
        if (is_inlier) ++inliers;
        if (pass == 1) keep[j] = is_inlier ? 1 : 0;
      }
      if (pass == 0 && (inliers > best_inliers || (inliers == best_inliers && sum < best_sum))) {
        best = i;
        best_inliers = inliers;
        best_sum = sum;
      }
    }
  }
  return best_inliers;
}

}  // namespace pf
