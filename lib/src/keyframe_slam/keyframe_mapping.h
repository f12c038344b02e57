#pragma once

#include "belief/pose_evidence.h"
#include "keyframe_slam/adjustment/keyframe_adjustment.h"
#include "keyframe_slam/loops/loops.h"
#include "keyframe_slam/memory/map_saving.h"
#include "keyframe_slam/planes/plane_upkeep.h"
#include "keyframe_slam/start/keyframe_record.h"
#include "keyframe_slam/tracking/point_search.h"
#include "keyframe_slam/tracking/pose_measurement.h"
#include "keyframe_slam/tracking/relocaliser.h"

/// Keeps the map of the window: gives points depths, adds keyframes and adjusts them, and adds new points.

namespace pf {

class Archive;

class KeyframeMapping {
 public:
  KeyframeMapping(const Settings& settings, KeyframeMap& map, Frame& frame, KeyframeMotion& motion,
                  KeyframePlanes& planes, const NoiseModel& noise, const PointSearch& search, const GivenPixels& given,
                  const PoseMeasurement& pose, KeyframeRecord& record, KeyframeRelocaliser& relocaliser,
                  const PoseBelief& belief)
      : settings_(settings),
        map_(map),
        frame_(frame),
        motion_(motion),
        planes_(settings, map, planes),
        noise_(noise),
        search_(search),
        given_(given),
        pose_(pose),
        record_(record),
        keeper_(relocaliser.keeper()),
        adjustment_(settings, map, planes, noise),
        loops_(settings, map, planes, noise, search.images(), belief),
        saving_(settings, map, planes, keeper_) {}

  bool layout(Arena& arena) {
    saving_.layout(arena);
    loops_.layout(arena);
    return adjustment_.layout(arena);
  }
  void init() {
    planes_.init();
    adjustment_.init();
    loops_.init();
    saving_.init();
  }

  /// The work of one frame. tracked: its matches support its pose; other frames change nothing in the map, but for the first one. young: so
  /// few points have a depth that those without took part in the pose. share: of searches that find something, in earlier frames. Returns
  /// whether the frame became a keyframe.
  bool keep(bool tracked, bool young, Scalar median_depth, const FindShare& share);
  /// Adjusts the map about the newest keyframe, which is this frame, and moves the body with it.
  void adjust();

  KeyframeAdjustment& adjustment() { return adjustment_; }
  const KeyframeAdjustment& adjustment() const { return adjustment_; }
  Loops& loops() { return loops_; }
  MapSaving& saving() { return saving_; }
  const MapSaving& saving() const { return saving_; }

  void carry(Archive& archive);  ///< base/archive.h

 private:
  void triangulate_inliers(bool young);
  bool wants_keyframe(bool young, Scalar median_depth) const;
  void add_frame(bool young, Scalar median_depth);
  void add_points(bool pending, Scalar median_depth);

  const Settings& settings_;
  KeyframeMap& map_;
  Frame& frame_;
  KeyframeMotion& motion_;
  PlaneUpkeep planes_;
  const NoiseModel& noise_;
  const PointSearch& search_;
  const GivenPixels& given_;
  const PoseMeasurement& pose_;
  KeyframeRecord& record_;
  PlaceKeeper& keeper_;
  KeyframeAdjustment adjustment_;
  Loops loops_;
  MapSaving saving_;
};

}  // namespace pf
