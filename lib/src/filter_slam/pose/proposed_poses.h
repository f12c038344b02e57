#pragma once

#include <cstdint>

#include "filter/filter.h"
#include "frame/pose_hypotheses.h"
#include "frame/settings.h"

/// Poses that the matches of consecutive frames propose before one is accepted.

namespace pf {

class Archive;

/// After a gap a single frame may agree with the map by chance, or because an image like the last one is shown once more: of frames in
/// random order one in twenty is a neighbour of the one before. The distinction is whether the next frame proposes a pose to which a hand
/// can have moved the camera in the meantime.
class ProposedPoses {
 public:
  ProposedPoses(const Settings& settings, const Filter& filter) : settings_(settings), filter_(filter) {}

  void init() { last_ = now_ = PoseProposal(); }
  /// Begins a frame, dt_ns after the one before, without a proposal.
  void begin_frame(std::int64_t dt_ns);
  /// Proposal of the frame before.
  const PoseProposal& last() const { return last_; }
  /// Sets this frame's proposal; a second one replaces the first. before: log-odds of a pose near the prediction before this frame's
  /// evidence. Where the last frame made a proposal, its log-odds count in place of that if the camera can have moved from there to here;
  /// if not, one of the two is wrong. Returns the log-odds with this frame's evidence.
  Scalar propose(const Quat& q_WC, const Vec3& p_W, Scalar depth, Scalar before, Scalar evidence);

  void carry(Archive& archive);  ///< base/archive.h

 private:
  bool follows(const PoseProposal& next) const;

  const Settings& settings_;
  const Filter& filter_;
  PoseProposal last_, now_;
  std::int64_t dt_ns_ = 0;
};

}  // namespace pf
