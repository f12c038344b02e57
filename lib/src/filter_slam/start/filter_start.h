#pragma once

#include "base/status.h"
#include "filter/filter.h"
#include "filter_slam/features/corner_features.h"
#include "filter_slam/features/feature_keeper.h"
#include "filter_slam/features/feature_search.h"
#include "filter_slam/memory/filter_memory.h"
#include "filter_slam/pose/pixel_update.h"
#include "filter_slam/start/map_beginning.h"
#include "filter_slam/start/start_recorder.h"
#include "frame/frame.h"
#include "frame/settings.h"
#include "frame/start/start.h"
#include "frame/start/start_at_target.h"
#include "frame/tracking_state.h"
#include "inertial/body_motion.h"
#include "inertial/kept_mounting.h"
#include "map/map.h"

/// Starts the filter by the caller's method: at a known pose, at a target, or from a record of the first frames.

namespace pf {

class Archive;

class FilterStart {
 public:
  /// update: for its scratch.
  FilterStart(const Settings& settings, const BodyMotion& motion, Filter& filter, Map& map, Frame& frame,
              TrackingState& tracking, FeatureKeeper& features, FeatureSearch& search, CornerFeatures& corners,
              PixelUpdate& update)
      : settings_(settings),
        filter_(filter),
        map_(map),
        frame_(frame),
        tracking_(tracking),
        features_(features),
        search_(search),
        mounting_(settings.body, settings.unit, filter),
        beginning_(settings, motion, mounting_, filter, map, frame, tracking),
        recorder_(settings, motion, target_, beginning_, filter, map, frame, features, corners, update) {}

  bool layout(Arena& arena, int width, int height);
  void init();
  /// Clears everything that came from the estimate, and the caller's first pose, which belongs to the first map. A target that was not
  /// withdrawn is kept and may be found again.
  void start_over();

  // --- what the caller chooses
  Status use_target(const Target& target);
  Status use_pose(const KnownBody& known);
  /// True where the caller defines W, so that walls can be given in it.
  bool has_place() const { return data_.has_place; }
  /// Rows of the state that the target's points will take.
  int target_rows() const;
  /// A rectangle can only be found in an image, not in a list of observations.
  bool takes_images_only() const { return target_.target().kind == TargetKind::kRectangle; }

  /// Begins in a saved map that was opened, before the first frame: lost, and with the lengths of the map. kState: a start was chosen.
  /// Others: FilterMemory::load.
  Status use_map(const SavedMap& saved, FilterMemory* memory);

  // --- the first frame
  /// Sets the pose of the first frame. False where that is not possible in this frame.
  bool start_in_image();
  void start_with_observations();

  // --- later frames
  /// A target, walls or a known speed fix the scale, not the samples of a unit.
  bool knows_scale() const { return data_.knows_scale; }
  /// Where most points that this frame saw before walls set apart have one ratio of distances in common, scales the map to the plan and
  /// joins the walls to the state. Returns the factor; 0: not yet.
  Scalar look_for_walls();
  /// Replaces a map of unknown scale by one in metres that begins with this frame, of a camera that has been at rest since begin_ns. False,
  /// with nothing changed, where the map has to stay.
  bool begin_anew_at_rest(std::int64_t begin_ns);
  /// True for a map of unknown scale, which samples may scale once its depths are known.
  bool may_become_metric() const;
  /// Time since the map's first frame [s].
  double map_age() const;

  StartRecorder& recorder() { return recorder_; }
  const StartRecorder& recorder() const { return recorder_; }
  KeptMounting& mounting() { return mounting_; }
  const KeptMounting& mounting() const { return mounting_; }

  void carry(Archive& archive);  ///< base/archive.h

 private:
  /// What is kept between frames.
  struct Data {
    bool has_place = false;    ///< the caller gave the place of the start in W
    bool knows_scale = false;  ///< a target, walls or a known speed fix it
  };

  bool needs_record() const;
  bool is_young() const;
  void begin(const Target* target, bool fitted);
  void begin_without_target();
  void add_target_matches(const TargetSighting& sighting);

  const Settings& settings_;
  Filter& filter_;
  Map& map_;
  Frame& frame_;
  TrackingState& tracking_;
  FeatureKeeper& features_;
  FeatureSearch& search_;
  Data data_;
  StartAtTarget target_;
  KeptMounting mounting_;
  MapBeginning beginning_;
  StartRecorder recorder_;
};

}  // namespace pf
