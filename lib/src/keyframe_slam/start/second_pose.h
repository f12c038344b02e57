#pragma once

#include <cstdint>

#include "base/eigen.h"
#include "base/elapsed.h"
#include "keyframe_slam/start/tuning.h"

namespace pf {

/// A second place of the camera that the caller knows: its distance from the first one is the scale.
struct SecondPose {
  bool given = false;
  std::int64_t t_ns = 0;    ///< of its frame, to kMaxSecondNs
  Vec3 p_W = Vec3::Zero();  ///< the camera's
  bool estimated = false;   ///< the frame was recorded, and the record was solved
  Vec3 estimate_W = Vec3::Zero();

  /// Whether a frame of this time is the one, or comes after it.
  bool has_come(std::int64_t frame_ns) const {
    return frame_ns >= t_ns || elapsed_ns(frame_ns, t_ns) <= tuning::second_pose::kMaxSecondNs;
  }
  bool is_frame(std::int64_t frame_ns) const {
    return has_come(frame_ns) && (frame_ns <= t_ns || elapsed_ns(t_ns, frame_ns) <= tuning::second_pose::kMaxSecondNs);
  }
};

}  // namespace pf
