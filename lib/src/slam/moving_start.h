#pragma once

#include <cstdint>

#include "filter/moving_start.h"
#include "map/map.h"
#include "slam/body_motion.h"
#include "slam/frame.h"
#include "slam/settings.h"

/// Looks for metres and gravity while the camera moves in a map up to scale: keeps the pixels of a frame every few, with what the samples
/// say in between, finds the poses of these frames anew against the map as it is now, and solves for scale, gravity and the accelerometer's
/// bias. See lib/docs/inertial.md.

namespace pf {

class MovingStart {
 public:
  MovingStart(const Settings& settings, Filter& filter, const Map& map, const Frame& frame, const ImuLog& imu,
              const BodyMotion& motion)
      : settings_(settings), filter_(filter), map_(map), frame_(frame), imu_(imu), motion_(motion) {}

  void init() { data_ = Data(); }
  /// After a frame. usable: it is tracked in a map whose depths are known up to scale. depth: the median one of what is seen. True where
  /// *solution is sure of itself, fits, and both halves of the poses agree.
  bool note(bool usable, std::uint32_t map_id, Scalar depth, MovingSolution* solution);

 private:
  static constexpr int kMaxPixels = 40;

  /// A frame that is kept.
  struct View {
    struct Seen {
      std::uint32_t id;
      float x, y;  ///< [px]
    };
    Quat q_WC = Quat::Identity();
    Vec3 p_W = Vec3::Zero();
    // Samples since the view before, in axes of the unit there, integrated without accelerometer bias.
    Scalar dt = 0;
    Vec3 gyro_bias = Vec3::Zero();
    Vec3 v = Vec3::Zero(), p = Vec3::Zero();
    Eigen::Matrix<Scalar, 6, 6> by_bias = Eigen::Matrix<Scalar, 6, 6>::Zero();  ///< of (v, p)
    int count = 0;
    Seen seen[kMaxPixels];
  };

  struct Data {
    int count = 0;
    std::int64_t t_ns = 0;  ///< of the last view
    std::uint32_t map_id = 0;
    View view[kMaxMovingPoses];
  };

  bool add();
  bool has_depth(int entry) const;
  bool locate(View* view) const;
  int find_poses(MovingPose* pose);
  bool is_accepted(const MovingPose* pose, int count, const MovingStartNoise& noise, MovingSolution* solution) const;

  const Settings& settings_;
  Filter& filter_;
  const Map& map_;
  const Frame& frame_;
  const ImuLog& imu_;
  const BodyMotion& motion_;
  Data data_;
};

}  // namespace pf
