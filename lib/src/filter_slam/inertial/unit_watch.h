#pragma once

#include <cstdint>

#include "filter/filter.h"
#include "filter/imu_log.h"
#include "filter_slam/pose/body_motion.h"
#include "filter_slam/pose/pixel_update.h"
#include "frame/frame.h"
#include "frame/settings.h"

/// Watches whether the samples of the inertial unit agree with the pictures, and decides whether they move the body. See
/// lib/docs/inertial.md.
///
/// While they do, each frame's innovation of the pose is chi-square with six degrees of freedom. Page's sum of what exceeds a slack
/// finds a change soon and knows no fault by name:   s+ = max(0, s + nis - slack),   doubted where s > bound

namespace pf {

class UnitWatch {
 public:
  UnitWatch(const Settings& settings, Filter& filter, const Frame& frame, const ImuLog& imu, const BodyMotion& motion,
            PixelUpdate& update)
      : settings_(settings), filter_(filter), frame_(frame), imu_(imu), motion_(motion), update_(update) {}

  void layout(Arena& arena);
  void init();
  /// Before the body goes from one frame to the next: whether samples move it, which it is prepared for.
  void begin_frame(std::int64_t before_ns, std::int64_t t_ns);
  /// The body as it is now is what this frame's prediction begins from.
  void keep_prior(std::int64_t before_ns);
  /// Before the frame is measured. follows: the frame before was tracked, and so was the pose that this one's prediction begins at.
  void begin_measuring(bool follows);
  /// After it was measured. True where nothing was used of it, since it says so much against the prediction or since hardly anything was
  /// found: then it is to be measured again from another prediction.
  bool is_refused();
  /// Predicts the body as if no samples had come.
  void leave_prediction();
  /// After it was measured again: whether it is tracked now. Where nothing was found this time either, samples are as good as before.
  void settle(bool is_tracked);
  /// After a frame, dt_ns after the one before. True when the unit has just come into doubt.
  bool note(bool before_was_tracked, bool is_tracked, std::int64_t dt_ns);
  /// The map is given up, so there is nothing to prepare: the next one begins without samples.
  void begin_without();
  /// The map had been in metres for so short a time, when samples may have begun to be wrong, that it hangs on the doubted unit.
  bool is_map_on_trial() const;

  bool doubted() const { return data_ != nullptr && data_->doubted; }
  /// In all.
  std::int64_t doubted_ns() const { return data_ != nullptr ? data_->doubted_ns : 0; }

 private:
  /// Of a doubted unit since a test began: Welford's means and sums of squares.
  struct Trial {
    std::int64_t begin_ns = 0, saturated = 0;
    int count = 0;
    Vec3 off = Vec3::Zero(), rate = Vec3::Zero();  ///< gyro less rate, and the rate, in B [rad/s]
    Scalar off2 = 0, rate2 = 0;
    Scalar variance = 0;  ///< sum of those of the rate, over its axes
  };

  struct Data {
    Scalar sum = 0;
    bool doubted = false, fresh = false;  ///< fresh: it has just come into doubt
    bool passed = false;                  ///< the test; samples are used from the next frame on
    int doubts = 0;
    std::int64_t doubted_ns = 0;
    std::int64_t used_ns = 0;    ///< since it was doubted last
    std::int64_t metric_ns = 0;  ///< for how long the map has been tracked in metres
    std::int64_t sound_ns = 0;   ///< the same when the sum was zero last: since then the samples may have been wrong
    Body prior;                  ///< before this frame's prediction
    std::int64_t prior_ns = 0;
    bool follows = false;       ///< that prediction is by samples alone, from a tracked pose
    bool contradicted = false;  ///< in this frame, by what was found of it
    bool taken_back = false;    ///< in this frame
    Body tracked;               ///< at the last tracked frame
    std::int64_t tracked_ns = 0;
    Trial trial;
  };

  bool is_silent(std::int64_t t_ns) const;
  Scalar contradiction(bool before_was_tracked, bool is_tracked) const;
  void predict_again(bool by_samples);
  void note_rate();
  void leave_samples(std::int64_t before_ns);
  void return_to_samples(const ImuReading& reading);
  void try_again(bool follows);

  const Settings& settings_;
  Filter& filter_;
  const Frame& frame_;
  const ImuLog& imu_;
  const BodyMotion& motion_;
  PixelUpdate& update_;
  PartPointer<Data, kHasInertial> data_;  ///< null without the inertial motion model, which needs no room then
};

}  // namespace pf
