#pragma once

#include "base/status.h"
#include "frame/start/start.h"
#include "frame/start/start_at_target.h"
#include "keyframe_slam/adjustment/held_target.h"
#include "keyframe_slam/memory/map_saving.h"
#include "keyframe_slam/start/keyframe_record.h"

/// Starts the window by the caller's method: at a known pose, at a target, or from a record of the first frames.

namespace pf {

class Archive;

class KeyframeStart {
 public:
  KeyframeStart(const Settings& settings, KeyframeMap& map, Frame& frame, TrackingState& tracking,
                KeyframeMotion& motion, const ImageSearch& images, HeldTarget& held, MapSaving& saving,
                KeyframeRecord& record, SecondPose& second)
      : settings_(settings),
        map_(map),
        frame_(frame),
        tracking_(tracking),
        motion_(motion),
        images_(images),
        held_(held),
        saving_(saving),
        record_(record),
        second_(second) {}

  bool layout(Arena& arena) { return target_.layout(arena, settings_.camera.width, settings_.camera.height); }
  void init();
  /// Clears the map, all that came from it, and the caller's poses. A target that was not withdrawn may be found again.
  void start_over();

  Status use_target(const Target& target);
  Status use_pose(const KnownBody& known);
  /// Begins in a map that was opened, lost. kState: another start was chosen. kFull: MapSaving::load.
  Status use_map(const SavedMap& saved);
  bool is_in_loaded_map() const { return saving_.is_loaded(); }
  /// Sets the second pose, of the frame that comes at t_ns. kTime: that frame is past. kState: the scale is known. kRange: it is too near
  /// to the first place.
  Status use_second_pose(std::int64_t t_ns, const Vec3& p_W, Scalar sigma);
  /// W is the one that the caller knows: the start is at a pose, or at a target with a place.
  bool has_place() const { return has_place_; }
  /// It has a target, which gives the unit of length.
  bool is_at_target() const { return target_.has_target(); }
  /// Starts at a target and in a map that was opened need images.
  bool takes_images_only() const { return is_at_target() || is_in_loaded_map(); }
  /// Covariance of (theta, p) of the first pose in W.
  Mat6 first_covariance() const;
  /// First place of the camera: the caller's, or the one that defines W.
  Vec3 first_place_W() const { return known_.given ? known_.body.p_W : Vec3::Zero(); }

  /// Sets the pose of the first frame and makes it a keyframe. False where that is not possible in this frame.
  bool start_in_image();

  void carry(Archive& archive);  ///< base/archive.h

 private:
  void set_pose(bool at_target);
  void add_target(int keyframe, const TargetSighting& sighting);

  const Settings& settings_;
  KeyframeMap& map_;
  Frame& frame_;
  TrackingState& tracking_;
  KeyframeMotion& motion_;
  const ImageSearch& images_;
  HeldTarget& held_;
  MapSaving& saving_;
  KeyframeRecord& record_;
  SecondPose& second_;
  KnownBody known_;
  StartAtTarget target_;
  bool has_place_ = false;
};

}  // namespace pf
