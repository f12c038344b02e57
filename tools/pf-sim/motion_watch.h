#pragma once

#include "run.h"
#include "sim/trajectory.h"

namespace pfsim {

/// Judges the motion of the camera over windows of so many frames that follow each other and do not overlap: marks the pose where a window
/// begins, and compares the motion since then with the truth where it ends. A window is judged when it begins and ends in tracked frames.
class MotionWatch {
 public:
  explicit MotionWatch(int frames) : frames_(frames) {}

  /// After each frame with a pose. Writes nees_motion and what belongs to it into the row of a frame that ends a window.
  void look(pf_slam_t* slam, pf_status_t status, const pf::sim::Pose& truth, FrameRow& row);
  /// Windows that could not begin, for want of room in the state.
  int without_room() const { return without_room_; }

 private:
  int frames_;      ///< of a window; 0: no windows
  int since_ = -1;  ///< frames since the mark; -1: there is none
  pf::sim::Pose at_mark_;
  int without_room_ = 0;
};

}  // namespace pfsim
