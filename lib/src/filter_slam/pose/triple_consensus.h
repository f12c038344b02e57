#pragma once

#include "filter/filter.h"

/// Whether matches are consistent beyond chance: an a-contrario consensus over triples. See lib/docs/states.md.

namespace pf {

struct TripleConsensus {
  int inliers = 0;
  Scalar log_false = 0;  ///< ln of the expected number of consensuses as good as this one among random matches
};

/// Three matches fix a pose. Counts the other matches that lie where the joint covariance of all pixels, given the three, predicts
/// them, and compares that number with what random matches within the searched areas would give:
///
///   r_j|T = r_j - S_jT S_T^-1 r_T,   S_j|T = S_jj - S_jT S_T^-1 S_Tj,   p_j = q area(S_j|T) / searched area of j
///   NFA = C(found, 3) P(X >= inliers - 3),   X ~ Binomial(attempts - 3, mean of p_j),   q = tuning::chance::kMaxFindShare
///
/// The same with ellipses of 1/2, 1/4 and 1/8 of the area, and 1,000 times the NFA, since each is another trial and wrong places are not
/// quite random: what agrees closely is less likely to be chance than what lies anywhere within its gate.
///
/// Returns the triple with the smallest NFA. BlockFilter::project must have been called for the matches (PixelUpdate::begin).
///
/// searched_px2  area that was searched, of each match [px^2]
/// found         matches, at most capacity.max_observations; fewer than four give log_false = 0
/// attempts      features that were searched for, found or not
/// triples       how many are drawn
/// levels        ellipses of different sizes, 1 to kLevels
/// among         of each match: whether it may be in a triple; null: all
/// keep          gets the inliers of the best triple; null: only the count is wanted
/// src           a-contrario RANSAC (Moisan and Stival 2004); the binomial's tail bounds that of trials with different p_j (Hoeffding 1956)
TripleConsensus find_triple_consensus(const Filter& filter, const PixelMeasurement* matches, const Scalar* searched_px2,
                                      int found, int attempts, Scalar gate, int triples, int levels,
                                      const unsigned char* among, unsigned char* keep);

}  // namespace pf
