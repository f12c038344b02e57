#pragma once

#include <cstdint>

#include "base/elapsed.h"
#include "base/hooks.h"
#include "base/status.h"
#include "belief/pose_belief.h"
#include "frame/frame.h"
#include "frame/settings.h"

/// State of the tracking (starting, tracking, coasting, lost), and the status that a frame returns.

namespace pf {

class Archive;

/// With the numbers of pf_state_t.
enum class SlamState : int { kStarting = 0, kTracking = 1, kCoasting = 2, kLost = 3 };

/// Progress of a start without a target. No start is under way if `recording` is false.
struct StartProgress {
  bool recording = false;
  bool depth_known = false;
  bool checking = false;  ///< a record goes on beside a start at a target, to check the depths that came of it

  /// True while no depth has been solved, so that the map has neither scale nor reliable depths.
  bool pending() const { return recording && !depth_known; }
};

class TrackingState {
 public:
  explicit TrackingState(const Settings& settings) : settings_(settings) {}

  void init() { data_ = Data(); }
  /// Begins a frame, dt_ns after the one before.
  void begin_frame(std::int64_t dt_ns) {
    data_.from_target = data_.started_over = data_.unusable = false;
    data_.belief.begin_frame(seconds(dt_ns));
  }
  /// Notes that this frame's image is usable. While lost, its dt_ns (since the frame before) count towards motion.restart_s.
  void note_usable_image(std::int64_t dt_ns) { data_.usable_ns += data_.lost ? dt_ns : 0; }
  /// Sets the time of the map's first pose. The first pose of all defines W; after a loss several images must agree on the motion between
  /// them first. lost: in a loaded map, where the camera may be anywhere.
  void set_has_pose(std::int64_t t_ns, bool lost = false) {
    data_.has_pose = true;
    data_.lost = lost;
    if (lost) data_.state = SlamState::kLost;
    if (lost) return data_.belief.begin_elsewhere();
    if (!data_.may_skip_target) data_.belief.trust();
    data_.last_tracked_ns = t_ns;
  }
  /// This frame's pose comes from the target.
  void set_from_target() {
    data_.from_target = true;
    data_.belief.trust();
  }
  /// Gives the last pose the time of a frame that repeats the one before.
  void repeat(std::int64_t t_ns) { data_.last_tracked_ns = t_ns; }
  void note_update(bool done) { data_.failed_updates = done ? 0 : data_.failed_updates + 1; }
  /// Begins anew after the estimate was discarded in this frame. A target is not skipped by the next start.
  void start_over() {
    begin_map();
    data_.may_skip_target = false;
    data_.started_over = true;
  }
  /// Begins a new map after the old one was discarded because it was not found again. It may begin without a target. The id of a W in which
  /// there was a pose is not used again.
  void begin_map() {
    const std::uint32_t last = data_.last_map_id, map_id = data_.has_pose ? last + 1 : data_.map_id;
    data_ = Data();
    data_.map_id = map_id;
    data_.last_map_id = last > map_id ? last : map_id;
    data_.may_skip_target = true;
    data_.belief.begin_elsewhere();
  }
  /// Gives the map another id: a new one, since its unit of length has changed, or that of the earlier map that it is joined to.
  void rename_map(std::uint32_t joined_to = 0) { data_.map_id = joined_to != 0 ? joined_to : ++data_.last_map_id; }
  /// Marks this frame's pose as measured, but too uncertain to use.
  void set_unusable() { data_.unusable = true; }
  /// Decides the state at the end of a frame, and of one that is not tracked the reason. Returns the status of the frame.
  Status conclude(const StartProgress& start, std::int64_t max_coast_ns, const Hooks& hooks, FrameReport* report);

  PoseBelief& belief() { return data_.belief; }
  const PoseBelief& belief() const { return data_.belief; }
  SlamState state() const { return data_.state; }
  bool has_pose() const { return data_.has_pose; }
  bool started_over() const { return data_.started_over; }
  /// True where so many updates in a row have failed that P is no valid covariance.
  bool updates_fail() const { return data_.failed_updates >= kMaxFailedUpdates; }
  /// True where the pose is only a prediction.
  bool coasting_or_lost() const { return data_.state == SlamState::kCoasting || data_.state == SlamState::kLost; }
  /// True where this frame's measurements support its pose.
  bool is_tracked(const FrameReport& report) const {
    return (report.inliers >= settings_.min_inliers || data_.from_target) && !data_.unusable;
  }
  /// True where the last frame did not support its pose, so that the map has to be found again before anything is measured.
  bool is_relocalising(const StartProgress& start) const { return coasting_or_lost() && !start.pending(); }
  /// Not while it is certain that the lens has changed: the new map would be as wrong as the old one's poses.
  bool needs_new_map(std::int64_t restart_ns) const {
    return restart_ns > 0 && data_.lost && data_.usable_ns >= restart_ns && !data_.belief.lens().has_changed();
  }
  /// Id of the current map; never used twice.
  std::uint32_t map_id() const { return data_.map_id; }
  /// Time of the last frame that supported its pose.
  std::int64_t last_tracked_ns() const { return data_.last_tracked_ns; }
  bool may_skip_target() const { return data_.may_skip_target; }

  void carry(Archive& archive);  ///< base/archive.h

 private:
  const Settings& settings_;
  static constexpr int kMaxFailedUpdates = 10;  ///< in a row

  struct Data {
    SlamState state = SlamState::kStarting;
    bool has_pose = false;
    bool from_target = false;  ///< this frame's pose comes from the target
    bool lost = false;
    bool unusable = false;  ///< this frame's pose
    bool may_skip_target = false;
    bool depths_known = false;  ///< in the last frame
    bool lens_said = false;     ///< that it has changed
    std::uint32_t map_id = 1;
    std::uint32_t last_map_id = 1;  ///< of all so far
    std::int64_t usable_ns = 0;     ///< of usable images while lost
    bool started_over = false;      ///< in this frame
    int failed_updates = 0;         ///< in a row
    std::int64_t last_tracked_ns = 0;
    PoseBelief belief;  ///< that the pose is right
  };
  Data data_;
};

}  // namespace pf
