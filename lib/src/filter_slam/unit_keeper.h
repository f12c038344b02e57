#pragma once

#include <cstdint>

#include "base/arena.h"
#include "filter/filter.h"
#include "filter/imu_log.h"
#include "filter_slam/pose/pixel_update.h"
#include "filter_slam/start/filter_start.h"
#include "filter_slam/start/metric_start.h"
#include "frame/frame.h"
#include "frame/settings.h"
#include "frame/tracking_state.h"
#include "inertial/body_motion.h"
#include "inertial/force_check.h"
#include "inertial/moving_start.h"
#include "inertial/rest_detector.h"
#include "inertial/rest_hold.h"
#include "inertial/unit_watch.h"
#include "map/map.h"

/// The inertial unit's part of a frame: predicts the body from samples, tests whether images agree with them, and starts metric scale and
/// gravity (lib/docs/theory/inertial.md). Without the inertial motion model this only predicts the body.

namespace pf {

class Archive;

/// What a frame did to the map's scale.
enum class ScaleChange : std::uint8_t {
  kNone,
  kMetric,   ///< gravity is known, and lengths are in metres; places and lengths are as before
  kNewMap,   ///< the same, and a new map begins with this frame
  kRescaled  ///< the same, and the map has been scaled
};

class UnitKeeper {
 public:
  UnitKeeper(const Settings& settings, Filter& filter, Map& map, Frame& frame, TrackingState& tracking,
             const ImuLog& imu, BodyMotion& motion, FilterStart& start)
      : settings_(settings),
        filter_(filter),
        map_(map),
        frame_(frame),
        tracking_(tracking),
        imu_(imu),
        motion_(motion),
        start_(start),
        rest_(settings, frame, imu, motion.unit_noise()),
        watch_(settings, filter, frame, imu, motion),
        metric_(settings, filter, map, tracking, start) {}

  void layout(Arena& arena);
  void init();
  /// The map is discarded.
  void begin_map();

  /// Predicts the body to this frame. before_ns: time of the frame before. follows: that one was tracked, and so was the pose that the
  /// prediction begins at. nothing_measured: that one had no inlier. depth: median, of what is seen.
  void predict(std::int64_t before_ns, bool follows, bool nothing_measured, Scalar depth);
  /// Measures the frame by measure(again, mode), which returns what its updates have found. Where images contradict a rest or samples,
  /// measures once more with again = true, from a prediction without them.
  template <typename F>
  void measure(bool follows, F&& measure);
  /// After a frame: starts metric scale where the camera has been at rest, or has moved enough. correlation_frames: for how many frames
  /// errors of pixels stay the same.
  ScaleChange look_for_scale(Scalar depth, Scalar correlation_frames);
  /// At the end of a frame, dt_ns after the one before: true where a new map has to begin. Images contradict the unit that alone gave this
  /// one its metres, or the camera left its first rest before the unit's clock and axes were known: the error of such a map is not known.
  bool discredits_map(bool follows, std::int64_t dt_ns);

  /// For pushed observations: samples measure the rotations of a start better than a record does. Where their clock or axes were found
  /// before this frame, a map of unknown scale that began without them is replaced.
  void let_samples_begin();
  /// Time from which on a prediction from now_ns goes through samples.
  std::int64_t motion_begin_ns(std::int64_t now_ns) const;
  /// Reason of discredits_map, for the log.
  const char* why_discredited() const;
  const UnitWatch& watch() const { return watch_; }
  /// Why samples do not move the body, or why lengths are not metres. *value, *R_CB: the numbers that belong to the reason, where it has
  /// any.
  UnitReason reason(Scalar* value, Mat3* R_CB) const;
  /// With the inertial motion model.
  const RestHold& hold() const { return parts_->hold; }
  const MetricStart& metric() const { return metric_; }
  /// Present estimate.
  ImuNoise noise() const { return motion_.unit_noise().now(); }
  /// Present estimate of the unit's mounting on the camera.
  Mounting mounting() const { return start_.mounting().now(); }

  void carry(Archive& archive);  ///< base/archive.h

 private:
  struct Parts {
    RestHold hold;
    MovingStart moving;
    ForceCheck forces;
  };

  MovingPoints moving_points() const;
  void note_forces();
  bool reads_force() const;
  bool begins_at_rest();
  bool holds() const { return parts_ != nullptr && parts_->hold.holds(); }
  void advance(std::int64_t before_ns, bool coasting_or_lost, bool nothing_measured);
  ScaleChange look_for_scale_in_motion(Scalar depth, Scalar correlation_frames);

  const Settings& settings_;
  Filter& filter_;
  Map& map_;
  Frame& frame_;
  TrackingState& tracking_;
  const ImuLog& imu_;
  BodyMotion& motion_;
  FilterStart& start_;
  RestDetector rest_;
  UnitWatch watch_;
  MetricStart metric_;
  enum class Discredit : std::uint8_t { kNone, kSamplesBegin, kLeftRest, kRejected };
  Discredit discredit_ = Discredit::kNone;  ///< why discredits_map says so
  bool has_just_aligned_ = false;           ///< samples move the body from this frame on
  PartPointer<Parts, kHasInertial> parts_;  ///< with the inertial motion model, in the block
};

template <typename F>
void UnitKeeper::measure(bool follows, F&& measure) {
  UpdateMode mode;
  bool again = false;
  if (holds()) {
    mode.max_pose_nis = watch_.begin_measuring(follows);
    if (!watch_.is_refused(measure(again, mode).is_contradicted)) return;
    parts_->hold.take_back();
    advance(parts_->hold.before_ns(), false, false);
    frame_.begin_again();
    again = true;
  }
  mode.max_pose_nis = watch_.begin_measuring(follows);
  mode.as_usual = mode.max_pose_nis > Scalar(0);
  mode.depths_first = parts_ != nullptr && parts_->hold.has_just_ended(frame_.report.t_ns);
  const UpdateOutcome outcome = measure(again, mode);
  if (outcome.is_pose_open) parts_->hold.forget();
  if (!watch_.is_refused(outcome.is_contradicted)) return;
  UpdateMode other;
  other.as_usual = !outcome.is_contradicted;
  watch_.leave_prediction();
  frame_.begin_again();
  measure(true, other);
  watch_.settle(tracking_.is_tracked(frame_.report));
  if (!other.as_usual || frame_.report.inliers > 0) return;
  frame_.begin_again();
  measure(true, UpdateMode());
}

}  // namespace pf
