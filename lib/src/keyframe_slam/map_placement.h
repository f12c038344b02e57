#pragma once

#include "keyframe_slam/inertial/keyframe_unit.h"
#include "keyframe_slam/keyframe_mapping.h"
#include "keyframe_slam/memory/keyframe_anchors.h"
#include "keyframe_slam/start/keyframe_start.h"
#include "keyframe_slam/walls/keyframe_walls.h"

/// Where the map of the window is in W, and its unit of length, as far as something beside its images gives them: a second pose, walls, or
/// an inertial unit.

namespace pf {

class Archive;

/// The pose that the caller marked.
struct MarkedPose {
  bool is_set = false;
  std::int64_t t_ns = 0;
  Quat q_WC = Quat::Identity();
  Vec3 p_W = Vec3::Zero();
  Mat6 covariance = Mat6::Zero();
};

/// Moves everything that is in the coordinates of the map.
class MapPlacement {
 public:
  MapPlacement(const Settings& settings, KeyframeMap& map, Frame& frame, TrackingState& tracking,
               KeyframeMotion& motion, KeyframePlanes& planes, KeyframeAnchors& anchors, KeyframeMapping& mapping,
               KeyframeRelocaliser& relocaliser, KeyframeRecord& record, KeyframeStart& start, KeyframeUnit& unit,
               SecondPose& second)
      : settings_(settings),
        map_(map),
        frame_(frame),
        tracking_(tracking),
        motion_(motion),
        planes_(planes),
        anchors_(anchors),
        mapping_(mapping),
        relocaliser_(relocaliser),
        record_(record),
        start_(start),
        unit_(unit),
        second_(second) {}

  bool layout(Arena& arena) { return walls_.layout(arena); }
  void init() {
    walls_.init();
    mark_ = MarkedPose();
  }

  /// Adds a wall. kState: planes are off, or W is not the plan's; kFull: there is no room for it.
  Status add_wall(const PlanePrior& prior, std::uint32_t* id);
  /// After the points of the map's first keyframe, which is at a pose that the caller knows: where most of them begin before walls, they
  /// begin on these, and the map in metres, without a record of first frames.
  void begin_at_walls(Scalar* median_depth);
  /// After the adjustment of a keyframe. While the unit of length is not known, walls stay apart until most points lie on them in one unit;
  /// the map gets another id where poses were given out in the old one. Multiplies *median_depth.
  void tend_walls(Scalar* median_depth);
  /// The map keeps its shape: the distance of the frame from the first place becomes the known one. Of a frame before depths were known,
  /// its place is the solved record's.
  void scale_by_second_pose(Scalar* median_depth);
  /// The inertial unit gives lengths in metres: by motion, where the map is scaled and goes on under another id, or by a rest.
  void scale_by_unit(const MovingSolution& solution, Scalar* median_depth);
  /// It does no more: the map goes on under another id.
  void leave_metres(const char* why);
  /// After the adjustment of a keyframe: the map goes where the samples say that it is.
  void follow_unit(Scalar* median_depth) {
    if (unit_.is_metric()) move(unit_.follow_adjustment(mapping_.adjustment()), median_depth);
  }
  /// What the inertial unit has to know of the map.
  MapOfUnit map_of_unit(Scalar median_depth) const;
  /// The map is joined to an earlier one: it goes on in that one's W and unit, under its id.
  void join(const MapJoin& join, Scalar* median_depth);
  /// The camera is back at a place: the window goes to where that has it, and what was made in between by its share.
  void close_loop(const LoopClosure& loop, Scalar* median_depth);
  /// The map has begun again with other poses, of which the newest keyframe has this frame's: anchors stay where they are before it.
  void keep_anchors(const CameraView& before, const CameraView& now) {
    anchors_.move({before.q_WC, before.c_W}, {now.q_WC, now.c_W}, tracking_.map_id());
  }

  /// Marks the pose of this frame. kState: there is none.
  Status mark_pose() {
    if (!tracking_.has_pose()) return Status::kState;
    mark_ = {true, frame_.report.t_ns, motion_.body().q_WC, motion_.body().p_W, motion_.pose_covariance()};
    return Status::kOk;
  }
  const MarkedPose& mark() const { return mark_; }
  /// What a pose of the map at p_W may be off in W, (theta, p), beside what it may be off in the map.
  Mat6 map_covariance(const Vec3& p_W) const;
  const KeyframeWalls& walls() const { return walls_; }
  const KeyframeUnit& unit() const { return unit_; }
  const KeyframePlanes& planes() const { return planes_; }

  void carry(Archive& archive);  ///< base/archive.h

 private:
  void move(const Similarity& T, Scalar* median_depth);
  void rename_map();
  void move_mark(const Similarity& T);

  const Settings& settings_;
  KeyframeMap& map_;
  Frame& frame_;
  TrackingState& tracking_;
  KeyframeMotion& motion_;
  KeyframePlanes& planes_;
  KeyframeAnchors& anchors_;
  KeyframeMapping& mapping_;
  KeyframeRelocaliser& relocaliser_;
  KeyframeRecord& record_;
  KeyframeStart& start_;
  KeyframeUnit& unit_;
  SecondPose& second_;
  KeyframeWalls walls_{settings_, map_, frame_, planes_};
  MarkedPose mark_;
};

}  // namespace pf
