#pragma once

#include "base/scalar.h"

/// Whether the lens is the one of the calibration: log-odds that it has changed (zoom, focus, another sensor), from frame to frame.

namespace pf {

class Archive;

/// Evidence of one image: ln of the ratio of two likelihoods of its log ratio s of focal lengths (ZoomFit, with variance v), of a lens that
/// has changed and of the calibrated one. A calibration is right within kKept, and changes have sizes up to about kChange:
///
///   E = ln N(s; 0, v + kChange^2) - ln N(s; 0, v + kKept^2),   |E| <= pose_belief::kMaxFrame
///
/// known: sigma of the focal length where the calibration itself is uncertain and estimated; it then replaces kKept.
Scalar lens_evidence(Scalar log_ratio, Scalar variance, Scalar known);

/// Log-odds L of a change, kLeast <= L <= kMost. A pose is as improbable as the lens by which it was measured.
class LensBelief {
 public:
  LensBelief();
  void begin_frame() { before_ = log_odds_; }
  /// Notes the evidence of this frame's pose; of several the last one counts. log_ratio: for the log.
  void note(Scalar evidence, Scalar log_ratio);
  /// True where poses that are measured with the calibration can be used.
  bool is_kept() const;
  /// True where the lens has changed, and not for a single image only.
  bool has_changed() const;
  Scalar log_odds() const { return log_odds_; }
  /// ln of the focal length over the calibrated one, by the last noted image.
  Scalar log_ratio() const { return log_ratio_; }

  void carry(Archive& archive);  ///< base/archive.h

 private:
  Scalar before_, log_odds_;
  Scalar log_ratio_ = 0;
};

}  // namespace pf
