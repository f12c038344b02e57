#pragma once

#include "filter/filter.h"
#include "filter_slam/features/corner_features.h"
#include "filter_slam/features/feature_keeper.h"
#include "filter_slam/pose/pixel_update.h"
#include "filter_slam/start/map_beginning.h"
#include "frame/frame.h"
#include "frame/settings.h"
#include "frame/start/start_at_target.h"
#include "frame/start/start_without_target.h"
#include "inertial/body_motion.h"
#include "map/map.h"

/// Records the first frames beside the filter, and begins the filter again where the record has better depths.

namespace pf {

class Archive;

class StartRecorder {
 public:
  /// update: for its scratch. target: that the map may have begun at.
  StartRecorder(const Settings& settings, const BodyMotion& motion, const StartAtTarget& target,
                MapBeginning& beginning, Filter& filter, Map& map, Frame& frame, FeatureKeeper& features,
                CornerFeatures& corners, PixelUpdate& update)
      : settings_(settings),
        motion_(motion),
        target_(target),
        beginning_(beginning),
        filter_(filter),
        map_(map),
        frame_(frame),
        features_(features),
        corners_(corners),
        update_(update) {}

  bool layout(Arena& arena);
  /// Ends a record, where there is one: nothing is recorded.
  void init() { record_.init(); }

  /// Depths are to come from a record that begins with this frame's features.
  void begin_start() { record_.begin(); }
  /// Depths are known, and a record that begins with this frame's features is to check them.
  void begin_check() { record_.begin_check(); }
  const StartProgress& progress() const { return record_.progress(); }
  bool is_recording() const { return progress().recording || progress().checking; }
  /// The lens is estimated while the record has yet to show that the first depths are right.
  bool learns_lens_from_first_depths() const { return progress().checking && adjusts_lens(); }

  /// Begins an empty record with the features that this frame has added.
  void begin_record();
  /// While a start without a target is under way: records the frame's pixels, and restarts the filter when the record gives better depths.
  /// After a start at a target, or before walls, does the same until the record confirms or contradicts the filter's depths. True: it
  /// contradicted them, and earlier places and poses are not valid. has_image: otherwise the caller's own observations begin features
  /// again.
  bool record_frame(bool has_image);

  void carry(Archive& archive);  ///< base/archive.h

 private:
  /// The lens of a start without a target is estimated with its depths, and not only considered.
  bool adjusts_lens() const { return settings_.lens.rows.shape_count() > 0 && settings_.body.considered_rows() == 0; }
  void add_pixels();
  bool check_depths(bool settled);
  void bound_baseline();
  void begin_anew(bool has_image);
  void stay_at_base();
  void restart(Scalar unit);
  void restart_known(Scalar unit);
  template <typename Rho>
  void restart_features(Rho&& rho_of, Scalar relative_sigma);
  int add_recorded(int anchor, int index, Scalar rho, Scalar relative_sigma);
  void update_with_target();
  Body base() const;

  const Settings& settings_;
  const BodyMotion& motion_;
  const StartAtTarget& target_;
  MapBeginning& beginning_;
  Filter& filter_;
  Map& map_;
  Frame& frame_;
  FeatureKeeper& features_;
  CornerFeatures& corners_;
  PixelUpdate& update_;
  StartWithoutTarget record_;
};

}  // namespace pf
