#pragma once

#include "base/status.h"
#include "frame/start/start.h"
#include "frame/start/start_at_target.h"
#include "frame/start/start_without_target.h"
#include "keyframe_slam/adjustment/adjustment.h"
#include "keyframe_slam/start/second_pose.h"
#include "keyframe_slam/tracking/tracking.h"

/// Starts the window in the way that the caller chose: at a known pose, at a target, or from a record of the first frames.

namespace pf {

/// The parts of the window that a start writes to.
struct KeyframeParts {
  KeyframeMap& map;
  Frame& frame;
  TrackingState& tracking;
  KeyframeMotion& motion;
  KeyframeTracking& measuring;
  KeyframeAdjustment& adjustment;
};

class KeyframeStart {
 public:
  KeyframeStart(const Settings& settings, const KeyframeParts& parts) : settings_(settings), parts_(parts) {}

  bool layout(Arena& arena);
  void init();
  /// Clears the map and what came from it, and the first pose that the caller gave. A target that was not withdrawn may be found again.
  void start_over();

  Status use_target(const Target& target);
  Status use_pose(const KnownBody& known);
  /// kState: the scale is known already.
  Status use_second_pose(std::int64_t t_ns, const Vec3& p_W);
  const SecondPose& second_pose() const { return data_.second; }
  /// Where the camera was first, as the caller knows it or as it defines W.
  Vec3 first_place_W() const { return data_.known.given ? data_.known.body.p_W : Vec3::Zero(); }
  /// The second pose has been used, or cannot be. A record that goes on ends, and the map keeps its scale.
  void end_second_pose();
  const StartProgress& progress() const { return without_.progress(); }

  /// Sets the pose of the first frame and makes it a keyframe. False: not possible in this frame.
  bool start_in_image();
  /// A frame while the depths are not known: follows the points, records them, and tries to solve the record. True: depths are known now,
  /// and this frame is a keyframe.
  bool follow_record();
  /// A tracked frame while the record goes on: records it. True: the record has better depths, and this frame is a keyframe.
  bool record_more();
  /// The camera has moved far enough for a keyframe. A record that has had no better solution for long is over; its depths stay.
  void note_keyframe();
  /// Begins an empty record with the features that this frame has added.
  void begin_record();

 private:
  void set_pose(bool at_target);
  void clear_map();
  bool accept_rotation(int found);
  Vec2 pixel_of(const Match& match) const;
  StartOutcome record_frame();
  void move_views();
  void set_speeds(Body* body) const;
  void take_record();

  struct Data {
    KnownBody known;
    SecondPose second;
    int solved_before = 0;  ///< frames since the record had a solution
  };

  const Settings& settings_;
  const KeyframeParts parts_;
  Data data_;
  StartAtTarget target_;
  StartWithoutTarget without_;
  Vec3* ray_ = nullptr;  ///< one for each point
  BundlePixel* pixel_ = nullptr;
  Scalar* scratch_ = nullptr;
  Scalar* record_rho_ = nullptr;  ///< of each feature of the record, while the depths are open
};

}  // namespace pf
