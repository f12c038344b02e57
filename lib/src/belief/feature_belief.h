#pragma once

#include "base/scalar.h"

/// Whether a feature is a point of the scene: its log-odds, from search to search.

namespace pf {

/// What one search says: ln of how much more likely its result is for a point of the scene than for what is none, as a rim that
/// slides along what is behind it, a reflection, a thing that has moved away. Such a thing is found where the pose has it as often as
/// chance finds anything there, q = tuning::chance::kMaxFindShare; a point of the scene with the probability d with which features are
/// found in this picture.
///
///   found where the pose has it   ln(d / q)
///   not, or found elsewhere       ln((1 - d) / (1 - q))
///
/// with d no less than q: of a picture in which next to nothing is found, neither says anything.
///
/// share: d, FindShare::in_frame()
Scalar feature_evidence(bool found, Scalar share);

/// The log-odds with one more search, no more than kMost: what many searches have found a dozen in vain undo.
Scalar updated_feature(Scalar log_odds, Scalar evidence);

/// It is no point of the scene, with a probability of 99 %.
bool is_no_point(Scalar log_odds);

}  // namespace pf
