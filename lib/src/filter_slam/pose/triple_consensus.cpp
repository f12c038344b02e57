#include "filter_slam/pose/triple_consensus.h"

#include <algorithm>
#include <cmath>

#include "base/false_alarms.h"
#include "base/limits.h"
#include "base/random_triples.h"
#include "filter_slam/pose/consensus.h"
#include "frame/tuning.h"
#include "geometry/small_cholesky.h"

namespace pf {
namespace {

constexpr Scalar kLogLevelCost = Scalar(6.9);  // ln 1,000, of a smaller ellipse

}  // namespace

TripleConsensus find_triple_consensus(const Filter& filter, const PixelMeasurement* matches, const Scalar* searched_px2,
                                      int found, int attempts, Scalar gate, int triples, int levels,
                                      const unsigned char* among, unsigned char* keep) {
  using namespace tuning::chance;
  TripleConsensus best;
  short pool[kMaxObservations];
  int size = 0;
  found = std::min(found, kMaxObservations);
  for (int i = 0; i < found; ++i)
    if (among == nullptr || among[i] != 0) pool[size++] = static_cast<short>(i);
  if (size < 4) {
    if (keep != nullptr) std::fill(keep, keep + found, static_cast<unsigned char>(0));
    return best;
  }
  RandomTriples random(size, 1);
  bool any = false;
  for (int trial = 0; trial < triples; ++trial) {
    int three[3];
    random.draw(three);
    for (int& index : three) index = pool[index];
    Mat6 S_T;
    Vec6 r_T;
    for (int a = 0; a < 3; ++a) {
      const PixelMeasurement& o = matches[three[a]];
      r_T.segment<2>(2 * a) = o.measured - o.predicted;
      for (int b = 0; b < 3; ++b) S_T.block<2, 2>(2 * a, 2 * b) = filter.innovation_block(three[a], three[b]);
      S_T.block<2, 2>(2 * a, 2 * a) += o.R_gate;
    }
    SmallCholesky<6> cholesky;
    if (!cholesky.factor(S_T)) continue;
    const Vec6 a_T = cholesky.solve<1>(r_T);
    if (!(r_T.dot(a_T) < kGateOfThree)) continue;
    int inliers[kLevels];
    Scalar share[kLevels] = {};
    std::fill(inliers, inliers + kLevels, 3);
    unsigned char is_inlier[kMaxObservations] = {};
    for (int j = 0; j < found; ++j) {
      if (j == three[0] || j == three[1] || j == three[2]) {
        is_inlier[j] = 1;
        continue;
      }
      Eigen::Matrix<Scalar, 6, 2> S_Tj;
      for (int a = 0; a < 3; ++a) S_Tj.block<2, 2>(2 * a, 0) = filter.innovation_block(three[a], j);
      const Eigen::Matrix<Scalar, 6, 2> X = cholesky.solve<2>(S_Tj);
      const Vec2 r = matches[j].measured - matches[j].predicted - S_Tj.transpose().lazyProduct(a_T);
      const Mat2 S = filter.innovation_block(j, j) + matches[j].R_gate - S_Tj.transpose().lazyProduct(X);
      const Scalar distance2 = squared_distance(r, S), area = ellipse_area(S, gate);
      is_inlier[j] = distance2 < gate ? 1 : 0;
      Scalar part = 1;
      for (int level = 0; level < levels; ++level, part /= 2) {
        share[level] += kMaxFindShare * std::min(Scalar(1), part * area / std::max(searched_px2[j], kMinArea));
        inliers[level] += distance2 < part * gate ? 1 : 0;
      }
    }
    Scalar log_false = 0;
    for (int level = 0; level < levels; ++level) {
      const Scalar mean = std::clamp(share[level] / static_cast<Scalar>(std::max(1, found - 3)), kMinShare, kMaxShare);
      Scalar at_level = log_false_alarms(inliers[level], std::max(attempts, found), mean, found);
      if (level > 0) at_level += kLogLevelCost;
      if (level == 0 || at_level < log_false) log_false = at_level;
    }
    if (any && log_false >= best.log_false) continue;
    any = true;
    best.inliers = inliers[0];
    best.log_false = log_false;
    if (keep != nullptr) std::copy(is_inlier, is_inlier + found, keep);
  }
  if (!any && keep != nullptr) std::fill(keep, keep + found, static_cast<unsigned char>(0));
  return best;
}

}  // namespace pf
