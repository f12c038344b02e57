#pragma once

#include <cstdint>

#include "geometry/small_cholesky.h"
#include "map/tuning.h"

/// Which points before a wall lie on it. Servant 2008, section 2.2 (lib/docs/theory/walls.md).

namespace pf {

/// The largest set of points (a bit each) that agree with each other, and with the wall's prior, that they lie on it. A wall that may be
/// tilted, and a world whose scale is hardly known, leave every single point's distance uncertain; given three of the points, those of the
/// others are known.
///
///   after a triple t:   r_j|t = r_j - S_jt S_tt^-1 r_t,   S_j|t = S_jj - S_jt S_tt^-1 S_tj
///
/// count         at most 32
/// r(j)          minus the distance of a point from the wall
/// S(i, j)       joint covariance of the distances, the wall's and its roughness included
/// gate          chi-square of a distance that is known
/// limit(j)      variance of one that is known well enough
/// random        state of the generator that draws triples
/// size          how many there are in the set
template <class Residual, class Innovation, class Limit>
unsigned find_wall_consensus(int count, const Residual& r, const Innovation& S, Scalar gate, const Limit& limit,
                             std::uint32_t* random, int* size) {
  using namespace tuning::plane_walls;
  const auto draw = [&] {
    *random = *random * 1664525u + 1013904223u;
    return static_cast<int>((*random >> 16) % static_cast<std::uint32_t>(count));
  };
  unsigned best = 0;
  *size = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    int t[3];
    for (int& member : t) member = draw();
    if (t[0] == t[1] || t[0] == t[2] || t[1] == t[2]) continue;
    Mat3 S_tt;
    Vec3 r_t;
    for (int a = 0; a < 3; ++a) {
      r_t(a) = r(t[a]);
      for (int b = 0; b < 3; ++b) S_tt(a, b) = S(t[a], t[b]);
    }
    SmallCholesky<3> cholesky;
    if (!cholesky.factor(S_tt)) continue;
    const Vec3 weighted = cholesky.template solve<1>(r_t);
    if (!(r_t.dot(weighted) < kTripleGate)) continue;
    unsigned inliers = 0;
    int found = 0;
    for (int j = 0; j < count; ++j) {
      bool is_inlier = j == t[0] || j == t[1] || j == t[2];
      if (!is_inlier) {
        const Vec3 S_jt(S(j, t[0]), S(j, t[1]), S(j, t[2]));
        const Scalar r_j = r(j) - S_jt.dot(weighted);
        const Scalar variance = S(j, j) - S_jt.dot(cholesky.template solve<1>(S_jt));
        is_inlier = variance <= limit(j) && r_j * r_j < gate * variance;
      }
      if (!is_inlier) continue;
      inliers |= 1u << j;
      ++found;
    }
    if (found <= *size) continue;
    *size = found;
    best = inliers;
  }
  return best;
}

}  // namespace pf
