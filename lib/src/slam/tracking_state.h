#pragma once

#include <cstdint>

#include "base/hooks.h"
#include "base/status.h"
#include "slam/frame.h"

/// Whether the camera is tracked: starting, tracking, coasting or lost, and what the caller is told.

namespace pf {

/// With the numbers of pf_state_t.
enum class SlamState : int { kStarting = 0, kTracking = 1, kCoasting = 2, kLost = 3 };

/// How far a start without a target has come; none is under way where `recording` is false.
struct StartProgress {
  bool recording = false;
  bool depth_known = false;

  /// No depth has been solved yet: there is no map to speak of.
  bool pending() const { return recording && !depth_known; }
};

class TrackingState {
 public:
  static constexpr int kMinInliers = 8;  ///< fewer do not carry a pose

  void init() { data_ = Data(); }
  void begin_frame() { data_.from_target = data_.started_over = false; }
  /// There is a pose from now on.
  void set_has_pose(std::int64_t t_ns) {
    data_.has_pose = true;
    data_.last_tracked_ns = t_ns;
  }
  /// This frame's pose comes from the target.
  void set_from_target() { data_.from_target = true; }
  void note_update(bool done) { data_.failed_updates = done ? 0 : data_.failed_updates + 1; }
  /// The estimate is no estimate any more: nothing but a new start follows in this frame.
  void start_over() {
    data_ = Data();
    data_.started_over = true;
  }
  /// What the caller is told at the end of a frame.
  Status conclude(const FrameReport& report, const StartProgress& start, std::int64_t max_coast_ns, const Hooks& hooks);

  SlamState state() const { return data_.state; }
  bool has_pose() const { return data_.has_pose; }
  bool started_over() const { return data_.started_over; }
  /// P is no covariance any more.
  bool updates_fail() const { return data_.failed_updates >= kMaxFailedUpdates; }
  /// The body moves by prediction alone.
  bool coasting_or_lost() const { return data_.state == SlamState::kCoasting || data_.state == SlamState::kLost; }
  /// This frame carries its pose.
  bool is_tracked(const FrameReport& report) const { return report.inliers >= kMinInliers || data_.from_target; }

 private:
  static constexpr int kMaxFailedUpdates = 10;  ///< that could not be made, in a row

  struct Data {
    SlamState state = SlamState::kStarting;
    bool has_pose = false;
    bool from_target = false;  ///< this frame's pose comes from the target
    bool lost = false;
    bool started_over = false;  ///< in this frame
    int failed_updates = 0;     ///< in a row
    std::int64_t last_tracked_ns = 0;
  };
  Data data_;
};

}  // namespace pf
