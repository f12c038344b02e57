#pragma once

#include "belief/pose_evidence.h"
#include "filter/filter.h"
#include "filter_slam/pose/leave_one_out.h"

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

/// Weighs the kept matches of such a consensus by all that they have in common, where the points themselves are little known: each match
/// then constrains the pixels of the next ones. fit: their joint fit (PixelUpdate::reject_contradicted).
///
///   ln p(r_rest | r_T) = ln N(r; 0, S) - ln N(r_T; 0, S_T)
///
/// T is the triple with the largest det S_T of those drawn, which does not depend on r. Nothing changes where S is not known.
void weigh_jointly(const Filter& filter, const PixelMeasurement* matches, const Scalar* searched_px2, int found,
                   int triples, const unsigned char* keep, const JointFit& fit, PoseConsensus* consensus);

}  // namespace pf
