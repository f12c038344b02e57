#pragma once

#include "base/scalar.h"

/// Whether a feature is a point of the scene: its log-odds, from search to search.

namespace pf {

/// Evidence of one search: ln of the ratio of two likelihoods of its result, of a point of the scene and of a feature that is none (a rim
/// that slides along what is behind it, a reflection, a thing that has moved away). The latter is found at its predicted place as often as
/// chance finds anything there, q = tuning::chance::kMaxFindShare; a point of the scene with the probability d with which features are
/// found in this image.
///
///   found where the pose has it   ln(d / q)
///   not, or found elsewhere       ln((1 - d) / (1 - q))
///
/// with d >= q: in an image in which hardly anything is found, neither result is evidence.
///
/// share: d, FindShare::in_frame()
Scalar feature_evidence(bool found, Scalar share);

/// The log-odds after one more search, at most kMost: a dozen misses undo any number of finds.
Scalar updated_feature(Scalar log_odds, Scalar evidence);

/// True where the feature is no point of the scene with a probability of 99 %.
bool is_no_point(Scalar log_odds);

}  // namespace pf
