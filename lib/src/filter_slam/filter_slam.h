#pragma once

#include <cstdint>

#include "base/arena.h"
#include "base/status.h"
#include "filter/filter.h"
#include "filter_slam/features/feature_keeper.h"
#include "filter_slam/features/image_front_end.h"
#include "filter_slam/features/observation_front_end.h"
#include "filter_slam/inertial/moving_start.h"
#include "filter_slam/inertial/rest_detector.h"
#include "filter_slam/inertial/rest_hold.h"
#include "filter_slam/inertial/unit_watch.h"
#include "filter_slam/patches/patch_keeper.h"
#include "filter_slam/planes/plane_keeper.h"
#include "filter_slam/pose/body_motion.h"
#include "filter_slam/pose/pixel_update.h"
#include "filter_slam/pose_mark.h"
#include "filter_slam/recovery/relocaliser.h"
#include "filter_slam/start/filter_start.h"
#include "frame/fit_warnings.h"
#include "frame/frame.h"
#include "frame/frozen_camera.h"
#include "frame/noise_model.h"
#include "frame/settings.h"
#include "frame/tracking_state.h"
#include "map/map.h"

/// The order of work of one frame with the filter as back end (Gee 2007), and nothing else:
///
///   predict -> where to look -> search -> consensus -> update -> (remaining candidates: again) -> map -> new features
///
/// Its parts refer to each other, so it is constructed in place and never copied.

namespace pf {

class FilterSlam {
 public:
  FilterSlam(const Settings& settings, Map& map, const ImuLog& imu) : settings_(settings), map_(map), imu_(imu) {}
  FilterSlam(const FilterSlam&) = delete;
  FilterSlam& operator=(const FilterSlam&) = delete;

  bool layout(Arena& arena);
  void init();

  Status push_frame(const ImageView& image, std::int64_t t_ns);
  Status push_observations(const PixelObservation* observations, int count, std::int64_t t_ns);
  /// Marks the pose of the last frame. kState: there is none; kFull: there is no room for it.
  Status mark_pose();

  /// Adds a wall. kState: planes are off, or W is not the plan's; kFull: there is no room for it.
  Status add_wall(const PlanePrior& prior, std::uint32_t* id);

  /// Plane with this id is vertical within sigma [rad], VerticalTable::tell. kState: gravity is not known. kNothing: no such plane.
  Status set_plane_vertical(std::uint32_t id, Scalar sigma);

  FilterStart& start() { return start_; }
  BodyMotion& motion() { return motion_; }
  ObservationFrontEnd& observations() { return observations_; }

  const UnitWatch& watch() const { return watch_; }
  const RestHold* hold() const { return &unit_->hold; }
  const FilterStart& start() const { return start_; }
  const BodyMotion& motion() const { return motion_; }
  const Filter& filter() const { return filter_; }
  const Frame& frame() const { return frame_; }
  const TrackingState& tracking() const { return tracking_; }
  const Relocaliser& relocaliser() const { return relocaliser_; }
  /// Time that the filter's body was predicted to: that of the last frame, or of the one that it repeats.
  std::int64_t filter_ns() const { return data_.filter_ns; }
  /// From when on a prediction has to go through samples.
  std::int64_t motion_begin_ns(std::int64_t now_ns) const;
  const NoiseModel& noise() const { return noise_; }
  /// Null where the config has no room for patches.
  const PatchKeeper* patches() const { return patches_; }

 private:
  struct Data {
    std::int64_t filter_ns = 0;
    std::int64_t since_last_ns = 0;  ///< from the frame before this one
    bool image_usable = false;       ///< this frame is an image that shows something to track
    bool follows = false;  ///< the frame before was tracked, and so was the pose that this one's prediction begins at
    bool map_discredited = false;  ///< by the unit that its scale came from: a new one begins
    FitWarnings warnings;
    Scalar median_depth = 1;  ///< of the inliers of the last tracked frame
  };

  void begin_frame(std::int64_t t_ns);
  Status end_frame();
  ConsensusRule consensus_rule(std::int64_t t_ns) const;
  void advance(std::int64_t before_ns, bool coasting_or_lost, bool nothing_measured);
  bool look_for_rest();
  void look_for_walls();
  bool look_for_scale();
  void layout_unit(Arena& arena);
  void init_unit();
  template <typename F>
  void measure_watched(F&& measure);
  void watch_unit();
  void learn_noise();
  bool layout_patches(Arena& arena);
  bool holds() const { return unit_ != nullptr && unit_->hold.holds(); }
  bool may_begin_patches(bool first) const;
  bool repair_covariance();
  void maintain_map(bool supported);
  void start_over();
  void begin_new_map(const char* why);
  void clear_estimate();

  const Settings& settings_;
  Map& map_;
  const ImuLog& imu_;
  Filter filter_;
  Frame frame_;
  NoiseModel noise_;
  TrackingState tracking_{settings_};
  FrozenCamera frozen_;
  BodyMotion motion_{settings_, filter_, imu_};
  RestDetector rest_{settings_, frame_, imu_};
  /// With the inertial motion model, in the block behind this.
  struct UnitParts {
    RestHold hold;
    MovingStart moving;
  };
  UnitParts* unit_ = nullptr;
  PixelUpdate update_{settings_, filter_, map_, frame_, tracking_};
  UnitWatch watch_{settings_, filter_, frame_, imu_, motion_, update_};
  FeatureKeeper features_{settings_, filter_, map_, frame_};
  PoseMark mark_{filter_, map_, features_};
  PlaneKeeper planes_{settings_, filter_, map_, frame_, features_};
  ImageFrontEnd images_{settings_, filter_, map_, frame_, features_, update_, noise_};
  Relocaliser relocaliser_{settings_, filter_, map_, frame_, images_, update_};
  ObservationFrontEnd observations_{settings_, filter_, map_, frame_, features_, update_};
  PatchKeeper* patches_ = nullptr;  ///< in the block behind this, where the config has room for patches
  FilterStart start_{settings_, motion_, {filter_, map_, frame_, tracking_, features_, images_, update_}};
  Data data_;
};

}  // namespace pf
