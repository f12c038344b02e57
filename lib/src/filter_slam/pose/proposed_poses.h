#pragma once

#include <cstdint>

#include "filter/filter.h"
#include "frame/pose_hypotheses.h"
#include "frame/settings.h"

/// Poses that the matches of consecutive frames propose before one is accepted.

namespace pf {

/// After a gap a single frame may agree with the map by chance, or because a picture like the last one is shown once more: of frames in
/// random order one in twenty is a neighbour of the one before. The distinction is whether the next frame proposes a pose to which a hand
/// can have moved the camera in the meantime.
class ProposedPoses {
 public:
  ProposedPoses(const Settings& settings, const Filter& filter) : settings_(settings), filter_(filter) {}

  void init() { last_ = now_ = PoseProposal(); }
  /// A frame begins, dt_ns after the one before, and has proposed nothing yet.
  void begin_frame(std::int64_t dt_ns);
  /// That of the frame before.
  const PoseProposal& last() const { return last_; }
  /// This frame's proposal; a second one takes the place of the first. before: log-odds that a pose near the prediction has before this
  /// frame's evidence. The last frame's proposal counts in its place: where the camera can have moved here from there, that one's log-odds;
  /// where not, one of the two is wrong. Returns the log-odds with this frame's evidence.
  Scalar propose(const Quat& q_WC, const Vec3& p_W, Scalar depth, Scalar before, Scalar evidence);

 private:
  bool follows(const PoseProposal& next) const;

  const Settings& settings_;
  const Filter& filter_;
  PoseProposal last_, now_;
  std::int64_t dt_ns_ = 0;
};

}  // namespace pf
