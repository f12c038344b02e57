#pragma once

#include <cstdint>

#include "base/arena.h"
#include "base/status.h"
#include "frame/fit_warnings.h"
#include "frame/frozen_camera.h"
#include "keyframe_slam/keyframe_mapping.h"
#include "keyframe_slam/map_placement.h"
#include "keyframe_slam/memory/keyframe_anchors.h"
#include "keyframe_slam/planes/planes.h"
#include "keyframe_slam/start/keyframe_start.h"
#include "keyframe_slam/tracking/keyframe_tracking.h"
#include "keyframe_slam/tracking/relocaliser.h"

/// The order of work of one frame with the window as back end (Masoud and Hoff 2015, Figure 4), and nothing else:
///
///   predict -> search -> pose -> points without a depth -> triangulate -> keyframe -> adjust -> new points
///
/// Its parts refer to each other, so it is constructed in place and never copied. lib/docs/theory/window.md

namespace pf {

class Archive;

class KeyframeSlam {
 public:
  KeyframeSlam(const Settings& settings, Map& map, const ImuLog& imu, const GivenPixels& given)
      : settings_(settings),
        map_{settings, map, frame_},
        anchors_{map.anchors, map_, planes_},
        unit_{settings, map_, frame_, noise_, imu, motion_},
        search_{settings, map_, planes_, frame_, noise_, given},
        mapping_{settings, map_,  frame_, motion_, planes_,      noise_,
                 search_,  given, pose_,  record_, relocaliser_, tracking_.belief()} {}
  KeyframeSlam(const KeyframeSlam&) = delete;
  KeyframeSlam& operator=(const KeyframeSlam&) = delete;

  bool layout(Arena& arena);
  void init();

  /// image: null where the frame has given pixels; kState then: the start that was chosen needs images.
  Status push_frame(const ImageView* image, std::int64_t t_ns);

  MapPlacement& placement() { return placement_; }
  KeyframeStart& start() { return start_; }

  const Frame& frame() const { return frame_; }
  const TrackingState& tracking() const { return tracking_; }
  const NoiseModel& noise() const { return noise_; }
  const KeyframeMap& map() const { return map_; }
  const MapPlacement& placement() const { return placement_; }
  const KeyframeMotion& motion() const { return motion_; }
  KeyframeMotion& motion() { return motion_; }
  /// Time of the body: that of the last frame, or of the one that it repeats.
  std::int64_t body_ns() const { return data_.body_ns; }
  /// Keeps the map: its adjustment has the map's covariance, and it saves the map.
  const KeyframeMapping& mapping() const { return mapping_; }
  int kept_views() const { return relocaliser_.kept_views(); }
  /// Of the inliers of the last tracked frame.
  Scalar median_depth() const { return data_.median_depth; }

  void carry(Archive& archive);  ///< base/archive.h

 private:
  struct Data {
    std::int64_t body_ns = 0;
    std::int64_t since_last_ns = 0;  ///< from the frame before this one
    Scalar median_depth = 1;         ///< of the inliers of the last tracked frame
    bool is_map_fixed = false;       ///< the map has come from what stands still in the image
    bool has_image = false;          ///< this frame
    bool young = false;  ///< in this frame so few points have a depth that those without are used for the pose
    SecondPose second;
    FrozenCamera frozen;
    FitWarnings warnings;
  };

  void begin_frame(std::int64_t t_ns);
  Status end_frame();
  void track();
  void measure();
  void learn();
  void discard_map();

  const Settings& settings_;
  Frame frame_;
  NoiseModel noise_;
  TrackingState tracking_{settings_};
  Data data_;
  KeyframeMap map_;
  KeyframeMotion motion_{settings_};
  KeyframePlanes planes_{settings_, map_};
  KeyframeAnchors anchors_;
  KeyframeUnit unit_;
  PointSearch search_;
  PoseMeasurement pose_{settings_, map_, frame_, noise_, search_};
  KeyframeTracking measuring_{settings_, map_, frame_, motion_, noise_, search_, pose_, tracking_.belief()};
  KeyframeRelocaliser relocaliser_{settings_,         map_, motion_, search_.images().tracker(), measuring_,
                                   tracking_.belief()};
  KeyframeRecord record_{settings_, map_, frame_, tracking_, motion_, noise_, search_, pose_, data_.second};
  KeyframeMapping mapping_;
  KeyframeStart start_{
      settings_,         map_,    frame_,      tracking_, motion_, search_.images(), mapping_.adjustment().target(),
      mapping_.saving(), record_, data_.second};
  MapPlacement placement_{settings_, map_,         frame_,  tracking_, motion_, planes_,     anchors_,
                          mapping_,  relocaliser_, record_, start_,    unit_,   data_.second};
};

}  // namespace pf
