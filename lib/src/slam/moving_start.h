#pragma once

#include <cstdint>

#include "filter/moving_start.h"
#include "slam/body_motion.h"
#include "slam/settings.h"

/// Looks for metres and gravity while the camera moves in a map up to scale: keeps a pose every few frames with what the samples say in
/// between, and solves for scale, gravity and the accelerometer's bias. See lib/docs/inertial.md.

namespace pf {

class MovingStart {
 public:
  MovingStart(const Settings& settings, Filter& filter, const ImuLog& imu, const BodyMotion& motion)
      : settings_(settings), filter_(filter), imu_(imu), motion_(motion) {}

  void init() { data_ = Data(); }
  /// After a frame. usable: it is tracked in a map whose depths are known up to scale. depth: the median one of what is seen. True where
  /// *solution is sure of itself, fits, and both halves of the poses agree with it.
  bool note(bool usable, std::int64_t t_ns, std::uint32_t map_id, Scalar depth, MovingSolution* solution);

 private:
  struct Data {
    int count = 0;
    std::int64_t t_ns = 0;  ///< of the last pose
    Mat3 R_WB = Mat3::Identity();
    std::uint32_t map_id = 0;
    MovingPose pose[kMaxMovingPoses];
  };

  bool add(std::int64_t t_ns);
  bool is_accepted(const MovingStartNoise& noise, MovingSolution* solution) const;

  const Settings& settings_;
  Filter& filter_;
  const ImuLog& imu_;
  const BodyMotion& motion_;
  Data data_;
};

}  // namespace pf
