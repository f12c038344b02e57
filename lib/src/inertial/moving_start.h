#pragma once

#include <cstdint>

#include "filter/moving_start.h"
#include "filter/sample_sums.h"
#include "frame/frame.h"
#include "frame/settings.h"
#include "geometry/rotation_smoother.h"
#include "inertial/body_motion.h"
#include "vision/appearance.h"

/// Looks for metres and gravity while the camera moves in a map up to scale: keeps the pixels of frames and the integrals of the samples in
/// between, estimates the poses of these frames anew against the present map, and solves for scale, gravity and the accelerometer's bias
/// (lib/docs/theory/inertial.md).

namespace pf {

class Archive;

/// Inputs of a frame beside its matches.
struct MovingFrame {
  CameraView view;
  bool is_placed;        ///< that is a pose in a map with depths
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
    rest_ = Rest();
  }
  /// After a change of the unit's delay: integrates the samples between the views again. Views without samples are dropped.
  void integrate_again();
  /// Readings of the rest that the views begin with, if there was one; null: none.
  const RestReading* rest() const { return rest_.is_first ? &rest_.reading : nullptr; }
  /// Sigma of the log scale of the last solution that was not accepted; 0: there was none.
  Scalar sigma_scale() const { return data_.sigma_scale; }
  /// True where accelerations with the opposite sign explain the motion, and the readings do not.
  bool is_reversed() const { return data_.reversed; }
  /// Before this frame is noted: the camera has been at rest from since_ns up to it, or almost, since a motion's beginning is not seen. The
  /// views begin with one of that rest, and its readings hold for their solution.
  void begin_at_rest(const RestReading& rest, std::int64_t since_ns);
  /// Notes a frame. True where *solution has small sigmas, fits, and both halves of the poses agree.
  bool note(const MovingFrame& told, const MovingPoints& points, MovingSolution* solution);

  void carry(Archive& archive);  ///< base/archive.h

 private:
  static constexpr int kMaxPixels = 64;
  static constexpr int kMaxHalvings = 3;  ///< 0.24 s between two views, for which samples are held
  using Float6 = Eigen::Matrix<float, 6, 6>;

  /// A frame that is kept, with large arrays in float.
  struct View {
    struct Seen {
      std::uint32_t id;
      float x, y;  ///< [px]
    };
    bool is_placed = false;  ///< by pixels, in a map with depths
    Quat q_WC = Quat::Identity();
    Vec3 p_W = Vec3::Zero();
    Float6 covariance = Float6::Zero();  ///< as of a PoseEstimate
    std::int64_t t_ns = 0;
    SampleSums samples;  ///< since the view before
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

  struct Rest {
    bool is_first = false;  ///< the first view is one of a rest, with these readings
    RestReading reading;
    int halvings = 0;  ///< of the views since, each of which doubles the time between two
  };

  bool add(const MovingFrame& told, const MovingPoints& points);
  void drop(int count);
  void halve();
  bool integrate(std::int64_t from_ns, View* view) const;
  bool locate(const MovingPoints& points, View* view) const;
  bool sweep(const MovingPoints& points);
  Vec3 smooth();
  int collect();
  MovingRest rest_of_first(Scalar depth, Scalar span) const;
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
  Rest rest_;
};

}  // namespace pf
