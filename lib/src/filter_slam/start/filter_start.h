#pragma once

#include "base/status.h"
#include "filter/filter.h"
#include "filter_slam/features/corner_features.h"
#include "filter_slam/features/feature_keeper.h"
#include "filter_slam/features/feature_search.h"
#include "filter_slam/pose/body_motion.h"
#include "filter_slam/pose/pixel_update.h"
#include "filter_slam/start/kept_mounting.h"
#include "filter_slam/start/map_beginning.h"
#include "filter_slam/start/start_recorder.h"
#include "frame/frame.h"
#include "frame/settings.h"
#include "frame/start/start.h"
#include "frame/start/start_at_target.h"
#include "frame/tracking_state.h"
#include "map/map.h"

/// Starts the filter in the way that the caller chose: at a known pose, at a target, or from a record of the first frames.

namespace pf {

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
  /// Clears everything that came from the estimate, and the first pose that the caller gave, which does not hold here. A target that
  /// was not withdrawn is kept and may be found again.
  void start_over();

  // --- what the caller chooses
  Status use_target(const Target& target);
  Status use_pose(const KnownBody& known);
  /// W is one that the caller knows, so that the place of other things can be said in it.
  bool has_place() const { return data_.has_place; }
  /// Rows of the state that the target's points will take.
  int target_rows() const;
  /// A rectangle can only be found in an image, not in a list of observations.
  bool takes_images_only() const { return target_.target().kind == TargetKind::kRectangle; }

  // --- the first frame
  /// Sets the pose of the first frame. False: not possible in this frame.
  bool start_in_image();
  void start_with_observations();

  // --- later frames
  /// A target, walls or a known speed tell the scale, and the samples of a unit did not.
  bool knows_scale() const { return data_.knows_scale; }
  /// Where most points that this frame saw before walls that were set apart have one ratio of distances in common: the map gets the size
  /// that the plan says, and the walls count from now on. Returns the factor; 0: not yet.
  Scalar look_for_walls();
  /// Gives up a map of unknown scale that may give way to one in metres: a new one begins with this frame, and the camera has been at rest
  /// since begin_ns. False: the map may not be given up, and nothing has changed.
  bool begin_anew_at_rest(std::int64_t begin_ns);
  /// A map that samples may scale, once its depths are known: of unknown scale.
  bool may_become_metric() const;
  /// Since the map's first frame [s].
  double map_age() const;

  StartRecorder& recorder() { return recorder_; }
  const StartRecorder& recorder() const { return recorder_; }
  KeptMounting& mounting() { return mounting_; }
  const KeptMounting& mounting() const { return mounting_; }

 private:
  /// What is kept between frames.
  struct Data {
    bool has_place = false;    ///< the caller said where in W the start is
    bool knows_scale = false;  ///< a target, walls or a known speed tell it
  };

  bool fits(const Target& target) const;
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
