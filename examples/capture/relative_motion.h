#ifndef PLANEFOLD_CAPTURE_RELATIVE_MOTION_H
#define PLANEFOLD_CAPTURE_RELATIVE_MOTION_H

#include <planefold/planefold.h>

#include <cstdint>

#include "view.h"

namespace pf::capture {

/// The motion of the camera over windows of so many frames that do not overlap, each from a mark to the motion since then. A window begins
/// and ends in tracked frames.
class RelativeMotion {
 public:
  /// 0 frames: no windows.
  /// has_length  the run has the truth's unit of length; otherwise the scale of each window is free (lib/docs/theory/relative_motion.md)
  void open(int64_t frames, bool has_length) {
    frames_ = frames;
    has_length_ = has_length;
  }

  /// After each frame. true: a window ends with it, and window() is that. truth: of this frame, or null.
  bool add(pf_slam_t* slam, const FrameView& view, const pf_pose_t* truth);
  const MotionWindow& window() const { return window_; }

  int64_t frames() const { return frames_; }
  int64_t windows() const { return windows_; }
  int64_t untracked() const { return untracked_; }
  int64_t without_room() const { return without_room_; }
  /// Mean per degree of freedom, of the windows with truth; negative where there are none.
  double nees_per_dof() const { return dof_ > 0 ? nees_ / static_cast<double>(dof_) : -1.0; }

 private:
  void judge(const pf_pose_t& truth);

  int64_t frames_ = 0;
  bool has_length_ = false;
  int64_t since_ = -1;  ///< frames since the mark; -1: there is none
  pf_pose_t truth_at_mark_{};
  bool has_truth_at_mark_ = false;
  MotionWindow window_;
  int64_t windows_ = 0, untracked_ = 0, without_room_ = 0, dof_ = 0;
  double nees_ = 0.0;
};

}  // namespace pf::capture

#endif
