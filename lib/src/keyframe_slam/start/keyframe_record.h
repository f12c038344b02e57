#pragma once

#include "frame/start/start_without_target.h"
#include "keyframe_slam/start/rotation_tracking.h"
#include "keyframe_slam/start/second_pose.h"

/// Start of the window with nothing known: records the first frames, and gives the map the depths and poses that solve the record.

namespace pf {

class Archive;

class KeyframeRecord {
 public:
  KeyframeRecord(const Settings& settings, KeyframeMap& map, Frame& frame, TrackingState& tracking,
                 KeyframeMotion& motion, const NoiseModel& noise, PointSearch& search, PoseMeasurement& pose,
                 SecondPose& second)
      : settings_(settings),
        map_(map),
        frame_(frame),
        tracking_(tracking),
        motion_(motion),
        noise_(noise),
        second_(second),
        rotation_(settings, map, frame, motion, search, pose) {}

  bool layout(Arena& arena);
  /// No record is under way. Depths of one that was stay.
  void init();
  /// A start is under way from this frame on; its record begins with the next keyframe.
  void begin();
  const StartProgress& progress() const { return solver_.progress(); }

  /// Begins an empty record with the features that this keyframe has added, if a start is under way.
  void begin_at_keyframe();
  /// A frame while the depths are not known: follows the points, records them, and tries to solve the record. True: depths are known now,
  /// and this frame is a keyframe.
  bool follow();
  /// A tracked frame after the depths are known: records it. True: the record has better depths, and this frame is a keyframe.
  bool improve();
  /// A record is under way that may still get a better solution: it waits for its first one, or has had one not long ago.
  bool is_improving() const;
  /// A keyframe is made. A record that improves no more is over; its depths stay.
  void note_keyframe();

  void carry(Archive& archive);  ///< base/archive.h

 private:
  Vec2 pixel_of(const Match& match) const;
  StartOutcome record_frame();
  void wait();
  void begin_again();
  void move_view(KeyframePoint* point, std::int64_t seen_ns) const;
  void set_speeds(Body* body) const;
  void set_first_speeds();
  void note_second_pose();
  void take_points();
  void free_readout();
  void take_readout();
  void take_solution();

  const Settings& settings_;
  KeyframeMap& map_;
  Frame& frame_;
  TrackingState& tracking_;
  KeyframeMotion& motion_;
  const NoiseModel& noise_;
  SecondPose& second_;
  RotationTracking rotation_;
  StartWithoutTarget solver_;
  Scalar* rho_ = nullptr;  ///< of each feature of the record, while the depths are open
  int solved_before_ = 0;  ///< frames since the record had a solution
};

}  // namespace pf
