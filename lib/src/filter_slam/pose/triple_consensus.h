#pragma once

#include "belief/pose_evidence.h"
#include "filter/filter.h"

/// Consensus of matches where the pose is hardly known: triples of them fix it. See lib/docs/theory/belief.md.

namespace pf {

/// Three matches fix a pose. The other matches are compared with their prediction by the joint covariance of all pixels, given the three:
///
///   r_j|T = r_j - S_jT S_T^-1 r_T,   S_j|T = S_jj - S_jT S_T^-1 S_Tj
///
/// Returns the consensus of the triple for which evidence_against_chance() is largest. Its density is that of the others given the three,
/// which are no evidence for the pose that they fix. BlockFilter::project must have been called for the matches (PixelUpdate::begin).
///
/// searched_px2  area that was searched, of each match [px^2]
/// found         matches, at most capacity.max_observations; fewer than four give no inliers
/// attempts      features that were searched for, found or not
/// triples       how many are drawn
/// keep          gets the inliers of the best triple
/// src           RANSAC with the likelihood as its score (MLESAC; Torr and Zisserman 2000)
PoseConsensus find_triple_consensus(const Filter& filter, const PixelMeasurement* matches, const Scalar* searched_px2,
                                    int found, int attempts, const FindShare& share, Scalar gate, int triples,
                                    unsigned char* keep);

}  // namespace pf
