#pragma once

#include <cstdint>

#include "base/arena.h"
#include "base/status.h"
#include "filter/filter.h"
#include "filter_slam/features/observation_front_end.h"
#include "filter_slam/followed_camera.h"
#include "filter_slam/image_tracking.h"
#include "filter_slam/map_upkeep.h"
#include "filter_slam/pose/pixel_update.h"
#include "filter_slam/start/filter_start.h"
#include "filter_slam/unit_keeper.h"
#include "frame/frame.h"
#include "frame/frozen_camera.h"
#include "frame/settings.h"
#include "frame/tracking_state.h"
#include "inertial/body_motion.h"
#include "map/map.h"

/// The order of work of one frame with the filter as back end (Gee 2007), and nothing else:
///
///   predict -> where to look -> search -> consensus -> update -> (remaining candidates: again) -> map -> new features
///
/// Its parts refer to each other, so it is constructed in place and never copied.

namespace pf {

class Archive;

class FilterSlam {
 public:
  FilterSlam(const Settings& settings, Map& map, const ImuLog& imu)
      : settings_(settings),
        map_(map),
        tracking_(settings),
        motion_(settings, filter_, imu),
        update_(settings, filter_, map, frame_, tracking_),
        upkeep_(settings, filter_, map, frame_, tracking_),
        images_(settings, filter_, map, frame_, tracking_, upkeep_.features(), update_),
        observations_(settings, filter_, map, frame_, upkeep_.features(), update_),
        start_(settings, motion_, filter_, map, frame_, tracking_, upkeep_.features(), images_.front_end().search(),
               images_.front_end().corners(), update_),
        unit_(settings, filter_, map, frame_, tracking_, imu, motion_, start_) {}
  FilterSlam(const FilterSlam&) = delete;
  FilterSlam& operator=(const FilterSlam&) = delete;

  bool layout(Arena& arena);
  void init();

  Status push_frame(const ImageView& image, std::int64_t t_ns);
  Status push_observations(const PixelObservation* observations, int count, std::int64_t t_ns);
  /// Marks the pose of the last frame. kState: there is none; kFull: there is no room for it.
  Status mark_pose();
  /// Sets an anchor from the camera of the last frame. kState: it is not tracked. Others: FilterAnchors::add.
  Status add_anchor(const AnchorRequest& asked, std::uint32_t* id);
  /// Adds a wall. kState: planes are off, or W is not the plan's; kFull: there is no room for it.
  Status add_wall(const PlanePrior& prior, std::uint32_t* id);

  FilterStart& start() { return start_; }
  BodyMotion& motion() { return motion_; }
  ObservationFrontEnd& observations() { return observations_; }
  MapUpkeep& upkeep() { return upkeep_; }

  /// Body and pose covariance (6x6) at the last frame, or predicted to a later time.
  void predict_pose(std::int64_t t_ns, Body* body, Mat6* covariance) const;
  const Filter& filter() const { return filter_; }
  const Frame& frame() const { return frame_; }
  const TrackingState& tracking() const { return tracking_; }
  const ImageTracking& images() const { return images_; }
  const MapUpkeep& upkeep() const { return upkeep_; }
  const UnitKeeper& unit() const { return unit_; }

  void carry(Archive& archive);  ///< base/archive.h

 private:
  /// What is kept between frames.
  struct Data {
    FrozenCamera frozen;
    std::int64_t filter_ns = 0;  ///< that the body was predicted to: of the last frame, or of the one that it repeats
    std::int64_t since_last_ns = 0;  ///< from the frame before this one
    bool image_usable = false;       ///< this frame is an image that shows something to track
    bool follows = false;  ///< the frame before was tracked, and so was the pose that this one's prediction begins at
    bool map_discredited = false;  ///< by the unit that its scale came from: a new one begins
    Scalar median_depth = 1;       ///< of the inliers of the last tracked frame
  };

  void begin_frame(std::int64_t t_ns);
  Status end_frame();
  void maintain(bool supported, bool is_first);
  bool look_for_scale();
  void start_over();
  void begin_new_map(const char* why);
  void clear_estimate();

  const Settings& settings_;
  Map& map_;
  Filter filter_;
  Frame frame_;
  TrackingState tracking_;
  BodyMotion motion_;
  PixelUpdate update_;
  MapUpkeep upkeep_;
  ImageTracking images_;
  ObservationFrontEnd observations_;
  FilterStart start_;
  UnitKeeper unit_;
  FollowedCamera followed_{filter_};
  Data data_;
};

}  // namespace pf
