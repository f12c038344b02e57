#pragma once

#include <cstdint>

#include "base/arena.h"
#include "base/status.h"
#include "filter/imu_log.h"
#include "filter_slam/filter_slam.h"
#include "frame/settings.h"
#include "keyframe_slam/keyframe_slam.h"
#include "map/map.h"
#include "session/map_calls.h"
#include "session/view.h"

/// What the API calls act on: input, choice of the start, and the back end that does the work.

namespace pf {

class Archive;

/// Kind of frames that a session accepts: the kind of its first frame.
enum class FrameKind { kUndecided, kImages, kObservations };

class Session {
 public:
  Session() = default;
  Session(const Session&) = delete;  // its back end refers to it
  Session& operator=(const Session&) = delete;

  /// With an arena that has no block, only counts.
  bool layout(Arena& arena, const Settings& settings);
  /// Starts from nothing. Needs a layout in a block.
  void init();

  // --- how to start; before the first frame
  Status start_from_target(const Target& target);
  Status start_from_pose(const KnownBody& known);
  Status add_wall(const PlanePrior& prior, std::uint32_t* id) {
    return has_filter() ? filter_->add_wall(prior, id) : window_->placement().add_wall(prior, id);
  }
  /// kState: with the filter, or the scale is known already.
  Status set_second_pose(std::int64_t t_ns, const Vec3& p_W, Scalar sigma) {
    return !has_filter() ? window_->start().use_second_pose(t_ns, p_W, sigma) : Status::kState;
  }
  void withdraw_target() { map_.target_withdrawn = true; }

  // --- what comes in
  bool takes_images() const { return data_.kind != FrameKind::kObservations; }
  bool takes_observations() const { return data_.kind != FrameKind::kImages; }
  bool takes_control() const { return settings_.constant_velocity; }
  /// The start that was chosen needs images.
  bool needs_images() const {
    return has_filter() ? filter_->start().takes_images_only() : window_->start().takes_images_only();
  }

  Status push_frame(const ImageView& image, std::int64_t t_ns);
  /// Of a session that takes observations: where those of the next frame are written, as many as inbox_size().
  PixelObservation* inbox() { return has_filter() ? filter_->observations().inbox() : given_.inbox(); }
  int inbox_size() const { return settings_.max_features + settings_.max_observations; }
  /// The first `count` of the inbox.
  Status push_observations(int count, std::int64_t t_ns);
  /// Known change of the velocities in camera axes, until the next frame.
  void push_control(const Vec3& dv_C, const Vec3& dw_C) {
    has_filter() ? filter_->motion().push_control(dv_C, dw_C) : window_->motion().push_control(dv_C, dw_C);
  }
  Status mark_pose() { return has_filter() ? filter_->mark_pose() : window_->placement().mark_pose(); }
  /// Calls that change the map without an image.
  MapCalls map_calls() { return MapCalls(settings_, map_, filter_, window_); }
  void push_imu(const ImuSample& sample) { imu_.add(sample); }
  void set_gravity(const Vec3& gravity_W) {
    data_.gravity_W = gravity_W, data_.gravity_map = view().tracking().map_id();
  }

  /// kState: gravity is not estimated, or not known yet. kNothing: no such plane.
  Status set_plane_vertical(std::uint32_t plane, Scalar sigma) {
    return has_filter() ? filter_->upkeep().set_plane_vertical(plane, sigma) : Status::kState;
  }

  // --- what can be read
  View view() const { return has_filter() ? View(settings_, map_, *filter_) : View(settings_, map_, *window_); }
  const Settings& settings() const { return settings_; }
  const ImuLog& imu() const { return imu_; }
  /// Gravity in the W of the current map as the caller gave it; zero: not given.
  Vec3 given_gravity_W() const;

  void carry(Archive& archive);  ///< base/archive.h

 private:
  /// What is kept between frames.
  struct Data {
    FrameKind kind = FrameKind::kUndecided;
    Vec3 gravity_W = Vec3::Zero();
    std::uint32_t gravity_map = 0;  ///< id of the map in whose W it was given
  };

  Settings settings_;
  Map map_;
  ImuLog imu_;
  GivenPixels given_;  ///< of the window; the filter has an inbox of its own
  ImageMask mask_;
  Data data_;
  bool has_filter() const { return !kHasWindow || filter_ != nullptr; }

  FilterSlam* filter_ = nullptr;  ///< the back end: one of the two is null
  KeyframeSlam* window_ = nullptr;
};

}  // namespace pf
