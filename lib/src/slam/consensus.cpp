#include "slam/consensus.h"

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

int agree(const Filter& filter, const PixelMeasurement* observations, int count, Scalar gate, unsigned char* keep) {
  int best = -1, best_votes = 0;
  Scalar best_sum = 0;
  for (int pass = 0; pass < 2; ++pass) {
    for (int i = 0; i < count; ++i) {
      if (pass == 1 && i != best) continue;
      const Mat2 Sii = filter.innovation_block(i, i) + observations[i].R_gate;
      const Mat2 Sii_inverse = inverse2(Sii);
      const Vec2 ri = observations[i].measured - observations[i].predicted;
      const Vec2 a = Sii_inverse * ri;
      int votes = 0;
      Scalar sum = 0;
      for (int j = 0; j < count; ++j) {
        bool agrees = true;
        if (j != i) {
          const Mat2 Sji = filter.innovation_block(j, i);
          const Vec2 r = observations[j].measured - observations[j].predicted - Sji * a;
          const Mat2 S = filter.innovation_block(j, j) + observations[j].R_gate - Sji * Sii_inverse * Sji.transpose();
          const Scalar d2 = squared_distance(r, S);
          agrees = d2 < gate;
          if (agrees) sum += d2;
        }
        if (agrees) ++votes;
        if (pass == 1) keep[j] = agrees ? 1 : 0;
      }
      if (pass == 0 && (votes > best_votes || (votes == best_votes && sum < best_sum))) {
        best = i;
        best_votes = votes;
        best_sum = sum;
      }
    }
  }
  return best_votes;
}

}  // namespace pf
