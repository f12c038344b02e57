#pragma once

#include "base/scalar.h"

/// Whether the lens is the one of the calibration: log-odds that it has changed (zoom, focus, another sensor), from frame to frame.

namespace pf {

/// What one picture says: ln of how much more likely its log ratio s of focal lengths (ZoomFit, with variance v) is for a lens that has
/// changed than for the calibrated one. A calibration is right within kKept, and a change may be any up to about kChange:
///
///   E = ln N(s; 0, v + kChange^2) - ln N(s; 0, v + kKept^2),   |E| <= pose_belief::kMaxFrame
///
/// known: sigma of the focal length where the calibration itself is uncertain and estimated; then it takes the place of kKept.
Scalar lens_evidence(Scalar log_ratio, Scalar variance, Scalar known);

/// Log-odds L of a change, kLeast <= L <= kMost. A pose is as improbable as the lens that it was measured with.
class LensBelief {
 public:
  LensBelief();
  void begin_frame() { before_ = log_odds_; }
  /// Of this frame's pose; of several the last one counts. log_ratio: for the message.
  void note(Scalar evidence, Scalar log_ratio);
  /// Poses that are measured with the calibration can be used.
  bool is_kept() const;
  /// It has changed, and not for a single picture.
  bool has_changed() const;
  Scalar log_odds() const { return log_odds_; }
  /// ln of the focal length over the calibrated one, by the last picture that was weighed.
  Scalar log_ratio() const { return log_ratio_; }

 private:
  Scalar before_, log_odds_;
  Scalar log_ratio_ = 0;
};

}  // namespace pf
