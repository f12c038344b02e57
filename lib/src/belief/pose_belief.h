#pragma once

#include "base/scalar.h"
#include "belief/lens_belief.h"
#include "belief/pose_evidence.h"
#include "belief/sharpness_belief.h"

/// Whether the pose is right: its log-odds, from frame to frame.

namespace pf {

class Archive;

/// A running log-odds L = ln(p / (1 - p)) that the pose is that of the camera in the map (lib/docs/theory/belief.md):
///
///   predicted   p <- p exp(-kHazard dt),  and no less than kAnew: where the camera should be may be right at any time
///   a frame     L <- L + E,   |E| <= kMaxFrame,   kElsewhere <= L <= kMost
///
/// E is pose_evidence() of the best hypothesis of the frame. A pose is used, and the frame tracked, where L reaches kTracked.
class PoseBelief {
 public:
  PoseBelief() { init(); }
  void init();
  /// Begins a frame, dt_s after the one before.
  void begin_frame(double dt_s);

  /// How sharp the frame's image is (vision/sharpness.h).
  void note_sharpness(Scalar log_sharpness);

  /// A map begins after a loss: the log-odds begin at kElsewhere, so that several images must agree on the motion between them.
  void begin_elsewhere();
  /// The prediction is too vague to search about: its log-odds fall to those of any other pose.
  void spend();
  /// Log-odds before this frame's evidence.
  Scalar predicted() const { return predicted_; }
  /// Log-odds of a pose that nothing supports yet.
  static Scalar anew();
  /// Log-odds of a pose that is not the predicted one.
  static Scalar elsewhere();
  static Scalar most();
  /// Log-odds of a pose after this frame's evidence, from those before it.
  static Scalar updated(Scalar before, Scalar evidence);
  /// Evidence of a consensus of this frame.
  Scalar evidence(const PoseConsensus& consensus) const { return pose_evidence(consensus, share_, alike_); }
  const FindShare& share() const { return share_; }
  /// Most that the log-odds of a pose elsewhere can be: however many images agree, the place may be another one that looks alike.
  Scalar most_elsewhere() const { return -alike_.log_share(); }
  /// A new part of the map: whether it looks like one that is elsewhere.
  void note_view(bool is_alike) { alike_.note(is_alike); }
  /// Notes the log-odds of a hypothesis of this frame; the greatest counts.
  void note(Scalar log_odds);
  /// Replaces what was noted: this pose has been used.
  void use(Scalar log_odds, const PoseConsensus& consensus);
  /// The pose comes from a target, from the record of a start that has been solved as a whole, or from pixels that the caller has matched.
  void trust() { use(most(), PoseConsensus()); }
  /// Log-odds of the pose, with this frame's evidence so far.
  Scalar log_odds() const { return is_noted_ ? log_odds_ : predicted_; }

  static bool is_enough(Scalar log_odds);
  /// A pose of this consensus may move the estimate: its log-odds are enough, and its lens is the calibrated one.
  bool may_use(Scalar log_odds, const PoseConsensus& consensus);
  const LensBelief& lens() const { return lens_; }
  /// It reaches kTracked even if the rest of the frame contradicts as much as one frame can (kMaxFrame).
  static bool is_settled(Scalar log_odds);
  /// The frame's pose is accepted: its log-odds reach kTracked.
  bool is_tracked() const { return is_enough(log_odds()); }

  void carry(Archive& archive);  ///< base/archive.h

 private:
  FindShare share_;
  AlikeShare alike_;
  LensBelief lens_;
  SharpnessBelief sharpness_;
  Scalar log_odds_ = 0, predicted_ = 0;
  Scalar least_ = 0;       ///< of a prediction
  bool is_noted_ = false;  ///< in this frame
};

}  // namespace pf
