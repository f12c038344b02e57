#pragma once

#include <cstdint>

#include "filter/moving_start.h"
#include "frame/frame.h"
#include "frame/settings.h"
#include "geometry/rotation_smoother.h"
#include "inertial/body_motion.h"

/// Looks for metres and gravity while the camera moves in a map up to scale: keeps the pixels of frames and the integrals of the samples in
/// between, estimates the poses of these frames anew against the present map, and solves for scale, gravity and the accelerometer's bias
/// (lib/docs/theory/inertial.md).

namespace pf {

class Archive;

/// Inputs of a frame beside its matches.
struct MovingFrame {
  bool keep;             ///< it is tracked in a map that samples may scale
  bool judge;            ///< depths of that map are known up to scale
  std::uint32_t map_id;  ///< of that map
  Scalar depth;          ///< median, of the measured points
  bool patient;          ///< the map is new: the start waits for a scale that is known well
  Scalar correlation;    ///< number of consecutive frames whose pixels have the same errors: 1 where each has its own
};

/// Points of the map of a back end, by which poses are estimated anew.
struct MovingPoints {
  const void* owner;
  const Camera& camera;
  /// False where the map has no such point, or its depth is not known but for the scale of all.
  bool (*find)(const void* owner, std::uint32_t id, Vec3* p_W);
  /// Pixel of an inlier of this frame, at the frame's time.
  Vec2 (*pixel_of)(const void* owner, const Match& match);
};

class MovingStart {
 public:
  MovingStart(const Settings& settings, const Filter& filter, const Frame& frame, const ImuLog& imu,
              const BodyMotion& motion)
      : settings_(settings), filter_(filter), frame_(frame), imu_(imu), motion_(motion) {}

  void init() {
    data_.count = data_.end = data_.left = 0;
    data_.sigma_scale = 0;
    data_.reversed = false;
  }
  /// After a change of the unit's delay: integrates the samples between the views again. Views without samples are dropped.
  void integrate_again();
  /// Sigma of the log scale of the last solution that was not accepted; 0: there was none.
  Scalar sigma_scale() const { return data_.sigma_scale; }
  /// True where accelerations with the opposite sign explain the motion, and the readings do not.
  bool is_reversed() const { return data_.reversed; }
  /// Notes a frame. True where *solution has small sigmas, fits, and both halves of the poses agree.
  bool note(const MovingFrame& told, const MovingPoints& points, MovingSolution* solution);

  void carry(Archive& archive);  ///< base/archive.h

 private:
  static constexpr int kMaxPixels = 64;
  using Float6 = Eigen::Matrix<float, 6, 6>;

  /// A frame that is kept, with large arrays in float.
  struct View {
    struct Seen {
      std::uint32_t id;
      float x, y;  ///< [px]
    };
    Quat q_WC = Quat::Identity();
    Vec3 p_W = Vec3::Zero();
    Float6 covariance = Float6::Zero();  ///< as of a PoseEstimate
    // Samples since the view before, in axes of the unit there, integrated without accelerometer bias.
    std::int64_t t_ns = 0;
    Scalar dt = 0;
    Vec3 gyro_bias = Vec3::Zero();
    Quat dq_B = Quat::Identity();
    Vec3 v = Vec3::Zero(), p = Vec3::Zero();
    Eigen::Matrix<float, 9, 6> by_bias = Eigen::Matrix<float, 9, 6>::Zero();  ///< of (phi, v, p)
    int count = 0;
    Seen seen[kMaxPixels];
  };

  struct Data {
    int count = 0;
    int frames = 0;         ///< since the last view
    std::int64_t t_ns = 0;  ///< of the last view
    std::uint32_t map_id = 0;
    Scalar sigma_scale = 0;
    bool reversed = false;
    Scalar delay_sigma = 0;  ///< [s] when the views were integrated
    int refused = 0;         ///< solutions in a row
    // Poses are estimated anew in sweeps over the views, from the last to the first, some views in each frame.
    int left = 0;            ///< views that this sweep has not reached
    int first = 0, end = 0;  ///< views that it has given a pose
    Scalar correlation = 1;  ///< of the pixels of neighbouring views
    View view[kMaxMovingPoses];
    RotationLink link[kMaxMovingPoses];
    MovingPose pose[kMaxMovingPoses];
  };

  bool add(const MovingPoints& points);
  bool integrate(std::int64_t from_ns, View* view) const;
  bool locate(const MovingPoints& points, View* view) const;
  bool sweep(const MovingPoints& points);
  Vec3 smooth();
  int collect();
  Scalar mean_variance(int row) const;
  Scalar turn_variance() const;
  Scalar scale_variance() const;
  MovingStartNoise::OfForce force_covariance() const;
  Scalar delay_variance() const;
  Scalar mean_rate2() const;
  Scalar turn_rate_sigma(Scalar span) const;
  bool is_accepted(const MovingPose* pose, int count, const MovingStartNoise& noise, bool patient,
                   MovingSolution* solution);
  void look_for_sign(int count, const MovingStartNoise& noise);

  const Settings& settings_;
  const Filter& filter_;
  const Frame& frame_;
  const ImuLog& imu_;
  const BodyMotion& motion_;
  Data data_;
};

}  // namespace pf
