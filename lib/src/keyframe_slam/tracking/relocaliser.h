#pragma once

#include "frame/pose_hypotheses.h"
#include "keyframe_slam/tracking/keyframe_tracking.h"

/// Finds the window's map again after frames that did not support the pose (lib/docs/theory/states.md).

namespace pf {

class KeyframeRelocaliser {
 public:
  KeyframeRelocaliser(const Settings& settings, const KeyframeMap& map, KeyframeMotion& motion, const Tracker& tracker,
                      KeyframeTracking& measuring, PoseBelief& belief)
      : settings_(settings), map_(map), motion_(motion), tracker_(tracker), measuring_(measuring), belief_(belief) {}

  bool layout(Arena& arena) { return views_.layout(arena, settings_.max_kept_views); }
  void init() {
    views_.init();
    proposal_ = PoseProposal();
  }

  /// Keeps the view of a tracked frame.
  void remember_view() { views_.keep_if_new(tracker_.pyramid(), motion_.body().q_WC, motion_.body().p_W); }
  /// The map is tracked: forgets what earlier frames proposed.
  void clear_proposal() { proposal_ = PoseProposal(); }
  /// The prediction is good enough to search about it.
  bool is_prediction_narrow(Scalar median_depth) const;
  /// Searches where the pose may be when the prediction is not: about the last frame's proposal, or a kept view that looks like this image.
  void recover(Scalar median_depth);

  int kept_views() const { return views_.count(); }

 private:
  const Settings& settings_;
  const KeyframeMap& map_;
  KeyframeMotion& motion_;
  const Tracker& tracker_;
  KeyframeTracking& measuring_;
  PoseBelief& belief_;
  ViewMemory views_;
  PoseProposal proposal_;  ///< of earlier frames
};

}  // namespace pf
