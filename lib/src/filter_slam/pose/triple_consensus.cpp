#include "filter_slam/pose/triple_consensus.h"

#include <algorithm>
#include <cmath>

#include "base/limits.h"
#include "base/random_triples.h"
#include "filter_slam/pose/consensus.h"
#include "filter_slam/pose/tuning.h"
#include "geometry/small_cholesky.h"

namespace pf {
namespace {

/// Three matches, and what all pixels are given them.
struct Triple {
  const int* index;  ///< of the three
  SmallCholesky<6> S;
  Vec6 a;          ///< S_T^-1 r_T
  Scalar nis = 0;  ///< r_T^T S_T^-1 r_T
};

/// False where their covariance is none.
bool condition_on(const Filter& filter, const PixelMeasurement* matches, const int* index, Triple* out) {
  Mat6 S;
  Vec6 r;
  for (int a = 0; a < 3; ++a) {
    const PixelMeasurement& o = matches[index[a]];
    r.segment<2>(2 * a) = o.measured - o.predicted;
    for (int b = 0; b < 3; ++b) S.block<2, 2>(2 * a, 2 * b) = filter.innovation_block(index[a], index[b]);
    S.block<2, 2>(2 * a, 2 * a) += o.R_gate;
  }
  out->index = index;
  if (!out->S.factor(S)) return false;
  out->a = out->S.solve<1>(r);
  out->nis = r.dot(out->a);
  return true;
}

/// Compares a match with what the three predict. False outside of the gate.
bool agrees(const Filter& filter, const PixelMeasurement* matches, const Triple& three, int j, Scalar gate,
            Scalar* log_density) {
  Eigen::Matrix<Scalar, 6, 2> S_Tj;
  for (int a = 0; a < 3; ++a) S_Tj.block<2, 2>(2 * a, 0) = filter.innovation_block(three.index[a], j);
  const Eigen::Matrix<Scalar, 6, 2> X = three.S.solve<2>(S_Tj);
  const Vec2 r = matches[j].measured - matches[j].predicted - S_Tj.transpose().lazyProduct(three.a);
  const Mat2 S = filter.innovation_block(j, j) + matches[j].R_gate - S_Tj.transpose().lazyProduct(X);
  const Scalar nis = squared_distance(r, S);
  if (!(nis < gate)) return false;
  *log_density = log_normal_density(nis, std::log(S.determinant()), 1);
  return true;
}

}  // namespace

PoseConsensus find_triple_consensus(const Filter& filter, const PixelMeasurement* matches, const Scalar* searched_px2,
                                    int found, int attempts, const FindShare& share, Scalar gate, int triples,
                                    unsigned char* keep) {
  PoseConsensus best;
  best.searched = attempts;
  found = std::min(found, kMaxObservations);
  std::fill(keep, keep + found, static_cast<unsigned char>(0));
  if (found < 4) return best;
  RandomTriples random(found, 1);
  Scalar best_evidence = 0;
  for (int trial = 0; trial < triples; ++trial) {
    int three[3];
    random.draw(three);
    Triple fixed;
    if (!condition_on(filter, matches, three, &fixed)) continue;
    if (!(fixed.nis < tuning::triple_consensus::kGateOfThree)) continue;  // the three contradict each other
    PoseConsensus consensus;
    consensus.searched = attempts;
    consensus.inliers = 3;
    unsigned char is_inlier[kMaxObservations] = {};
    for (int j = 0; j < found; ++j) {
      const bool is_of_three = j == three[0] || j == three[1] || j == three[2];
      Scalar log_density = 0;
      is_inlier[j] = is_of_three || agrees(filter, matches, fixed, j, gate, &log_density) ? 1 : 0;
      if (is_inlier[j] == 0 || is_of_three) continue;
      ++consensus.inliers;
      consensus.log_density += log_density;
      consensus.log_chance += log_chance_density(searched_px2[j]);
    }
    const Scalar evidence = evidence_against_chance(consensus, share);
    if (best.inliers > 0 && evidence <= best_evidence) continue;
    best = consensus;
    best_evidence = evidence;
    std::copy(is_inlier, is_inlier + found, keep);
  }
  return best;
}

void weigh_jointly(const Filter& filter, const PixelMeasurement* matches, const Scalar* searched_px2, int found,
                   int triples, const unsigned char* keep, const JointFit& fit, PoseConsensus* consensus) {
  int index[kMaxObservations], inliers = 0;
  Scalar log_chance = 0;
  for (int i = 0; i < found; ++i) {
    if (keep[i] == 0) continue;
    log_chance += log_chance_density(searched_px2[i]);
    index[inliers++] = i;
  }
  const bool has_fit = fit.nis > Scalar(0);
  consensus->inliers = inliers;
  if (inliers < 4 || !has_fit) return;
  RandomTriples random(inliers, 1);
  Scalar widest = 0, log_density = 0, chance_of_three = 0;
  bool has_triple = false;
  for (int trial = 0; trial < triples; ++trial) {
    int three[3];
    random.draw(three);
    for (int& a : three) a = index[a];
    Triple fixed;
    if (!condition_on(filter, matches, three, &fixed)) continue;
    const Scalar log_det = fixed.S.log_det();
    if (has_triple && !(log_det > widest)) continue;
    has_triple = true;
    widest = log_det;
    log_density = log_normal_density(fixed.nis, log_det, 3);
    chance_of_three = 0;
    for (const int a : three) chance_of_three += log_chance_density(searched_px2[a]);
  }
  if (!has_triple) return;
  consensus->log_density = log_normal_density(fit.nis, fit.log_det, inliers) - log_density;
  consensus->log_chance = log_chance - chance_of_three;
}

}  // namespace pf
