#pragma once

#include "filter/filter.h"

/// Whether matches agree better than chance would make them.

namespace pf {

struct Agreement {
  int inliers = 0;
  Scalar log_false = 0;  ///< ln of the expected number of agreements as good as this one that chance makes
};

/// What chance finds in wrong places of real frames: a match in at most this share of the searches, however large the ellipse, and in small
/// ellipses at most one match in an area of that share of a thousand pixels. Measured: 4 to 24 % of 48,000 searches, one in 1,100 px^2.
constexpr Scalar kChanceFind = Scalar(0.25);
constexpr Scalar kChanceArea = Scalar(250);  // [px^2]

/// Three matches fix a pose. After them, how many of the others lie where the joint covariance of all pixels puts them, against how many would
/// do so if chance had found every match somewhere in the area that was searched for it:
///
///   r_j|T = r_j - S_jT S_T^-1 r_T,   S_j|T = S_jj - S_jT S_T^-1 S_Tj,   p_j = 1/4 area of S_j|T's ellipse / searched area
///   NFA = C(found, 3) P(X >= inliers - 3),   X ~ Binomial(attempts - 3, mean of p_j)
///
/// The binomial's tail bounds that of trials with different p_j (Hoeffding 1956). begin_update must hold the observations.
///
/// searched_px2  of each match
/// attempts      features that were looked for, found or not
/// trials        triples that are drawn
/// among         of each match: whether it may be in a triple
/// keep          gets the matches that agree with the best triple; null: only the count is wanted
Agreement find_agreement(const Filter& filter, const PixelMeasurement* observations, const Scalar* searched_px2,
                         int found, int attempts, Scalar gate, int trials, const unsigned char* among,
                         unsigned char* keep);

}  // namespace pf
