#pragma once

#include "base/parts.h"
#include "frame/noise_model.h"
#include "frame/tracking_state.h"
#include "inertial/force_check.h"
#include "inertial/kept_mounting.h"
#include "inertial/moving_start.h"
#include "inertial/rest_detector.h"
#include "inertial/rest_hold.h"
#include "inertial/unit_watch.h"
#include "keyframe_slam/adjustment/keyframe_adjustment.h"
#include "keyframe_slam/inertial/map_ruler.h"
#include "keyframe_slam/map/keyframe_map.h"
#include "keyframe_slam/tracking/motion.h"

/// The inertial unit of the window: a filter over the body, its unit and one length of the map (MapRuler), which predicts the body by
/// samples and is corrected by the pose that each image has measured (lib/docs/theory/window.md, "An inertial unit").

namespace pf {

class Archive;

/// What is known of the map when a frame has been measured.
struct MapOfUnit {
  bool is_tracked = false;
  bool is_pending = false;   ///< it has no depths yet, or is a record that may begin again
  bool knows_scale = false;  ///< something else gives its unit of length
  std::uint32_t map_id = 0;
  Scalar median_depth = 1;
};

class KeyframeUnit {
 public:
  KeyframeUnit(const Settings& settings, const KeyframeMap& map, Frame& frame, const NoiseModel& noise,
               const ImuLog& imu, KeyframeMotion& motion)
      : settings_(settings), map_(map), frame_(frame), noise_(noise), imu_(imu), motion_(motion) {}

  void layout(Arena& arena);
  void init();
  /// The map is discarded.
  void begin_map();

  /// True where samples, or their filter, have predicted the body to this frame. follows: the frame before was tracked.
  bool predict(std::int64_t before_ns, bool follows, bool coasting_or_lost, bool nothing_measured, Scalar median_depth);
  /// Takes the pose that the frame has measured. True where the frame is to be measured again from another prediction, which the body has
  /// then: first without samples, if hardly anything was found about the one by samples, then by samples once more, if nothing was found
  /// at all, and is measured by all that can be found.
  bool take_pose(const MapOfUnit& map);
  /// After a frame. True the first time that samples give metres: by motion, with *solution, or, in a map whose unit is known, by a rest
  /// (is_from_motion()).
  bool look_for_scale(const MapOfUnit& map, MovingSolution* solution);
  /// At the end of a frame, dt_ns after the one before: why the samples that gave this map its metres give it none any more, in words;
  /// null: they do. They are contradicted, or the map has become another one whose size is not known.
  const char* leaves_metres(const MapOfUnit& map, std::int64_t dt_ns);
  /// After the adjustment of a keyframe: what the map may have moved in W. Returns by how much it is to be moved.
  Similarity follow_adjustment(const KeyframeAdjustment& adjustment);
  /// All of W is moved.
  void move(const Similarity& T);

  /// Covariance of a place of the map, as far as it follows from the size that samples give it. first_W: where W is.
  Mat3 covariance_of_scale(const Vec3& p_W, const Vec3& first_W) const;
  /// Body and covariance of (theta, p) at t_ns in the map. False where samples do not tell.
  bool predict_pose(std::int64_t now_ns, std::int64_t t_ns, Body* body, Mat6* covariance) const;

  // --- with the inertial motion model
  bool has_begun() const { return parts_ != nullptr && data_.has_begun; }
  bool is_metric() const { return has_begun() && parts_->filter.is_metric(); }
  bool is_from_motion() const { return is_metric() && data_.is_from_motion; }
  const Filter& filter() const { return parts_->filter; }
  const UnitWatch& watch() const { return parts_->watch; }
  const RestHold& hold() const { return parts_->hold; }
  ImuNoise noise() const { return parts_->motion.unit_noise().now(); }
  Mounting mounting() const { return parts_->mounting.now(); }
  UnitReason reason(Scalar* value, Mat3* R_CB) const;

  void carry(Archive& archive);  ///< base/archive.h

 private:
  struct Parts {
    Parts(const Settings& settings, Frame& frame, const ImuLog& imu)
        : motion(settings, filter, imu),
          mounting(settings.body, settings.unit, filter),
          rest(settings, frame, imu, motion.unit_noise()),
          watch(settings, filter, frame, imu, motion),
          hold(settings, filter, rest, imu, motion),
          moving(settings, filter, frame, imu, motion),
          forces(settings, imu) {}

    Filter filter;
    MapRuler ruler{filter};
    BodyMotion motion;
    KeptMounting mounting;
    RestDetector rest;
    UnitWatch watch;
    RestHold hold;
    MovingStart moving;
    ForceCheck forces;
  };
  struct Data {
    bool has_begun = false;
    bool is_from_motion = false;
    bool has_other = false;  ///< this frame has another prediction yet
    bool is_again = false;   ///< it is measured from another prediction than its first one
    bool follows = false;    ///< the frame before was tracked, and so was the pose that this one's prediction begins at
    std::int64_t begin_ns = 0;  ///< of the filter
    CameraView left;            ///< where the body was at the end of the last frame
    int newest = 0;             ///< number of the last keyframe whose adjustment was followed
  };

  bool begin(const MapOfUnit& map);
  void advance(std::int64_t before_ns, bool coasting_or_lost, bool nothing_measured);
  void put_prediction();
  bool update(Scalar max_nis);
  MovingPoints moving_points() const;

  const Settings& settings_;
  const KeyframeMap& map_;
  Frame& frame_;
  const NoiseModel& noise_;
  const ImuLog& imu_;
  KeyframeMotion& motion_;
  Data data_;
  PartPointer<Parts, kHasInertial> parts_;  ///< null without the inertial motion model
};

}  // namespace pf
