#pragma once

#include "base/status.h"
#include "filter/filter.h"
#include "filter/inertial_motion.h"
#include "filter/moving_start.h"
#include "filter_slam/features/feature_keeper.h"
#include "filter_slam/features/image_front_end.h"
#include "filter_slam/pose/body_motion.h"
#include "filter_slam/pose/pixel_update.h"
#include "frame/frame.h"
#include "frame/settings.h"
#include "frame/start/start.h"
#include "frame/start/start_at_target.h"
#include "frame/start/start_without_target.h"
#include "frame/tracking_state.h"
#include "map/map.h"

/// Starts the filter in the way that the caller chose: at a known pose, at a target, or from a record of the first frames.

namespace pf {

/// The parts of the frame loop that a start writes to.
struct StartedParts {
  Filter& filter;
  Map& map;
  Frame& frame;
  TrackingState& tracking;
  FeatureKeeper& features;
  ImageFrontEnd& images;
  PixelUpdate& update;  ///< for its scratch
};

class FilterStart {
 public:
  FilterStart(const Settings& settings, const BodyMotion& motion, const StartedParts& parts)
      : settings_(settings), motion_(motion), parts_(parts) {}

  bool layout(Arena& arena, int width, int height);
  void init();
  /// Empties the filter, and with it the table of planes.
  void clear_filter();
  /// Clears everything that came from the estimate, and the first pose that the caller gave, which does not hold here. A target that
  /// was not withdrawn is kept and may be found again.
  void start_over();

  /// A target, walls or a known speed tell the scale, and the samples of a unit did not.
  bool knows_scale() const { return data_.knows_scale; }
  /// Whether lengths are in metres since the samples of a moving camera told them.
  bool is_from_motion() const { return data_.from_motion; }

  /// Whether the target's points fit into the capacities.
  bool fits(const Target& target) const;
  Status use_target(const Target& target);
  Status use_pose(const KnownBody& known);
  /// W is one that the caller knows, so that the place of other things can be said in it.
  bool has_place() const { return data_.has_place; }
  /// Rows of the state that the target's points will take.
  int target_rows() const;
  /// A rectangle can only be found in an image, not in a list of observations.
  bool takes_images_only() const { return target_.target().kind == TargetKind::kRectangle; }

  /// Sets the pose of the first frame. False: not possible in this frame.
  bool start_in_image();
  void start_with_observations();
  const StartProgress& progress() const { return without_.progress(); }
  /// The lens is estimated while the record has yet to show that the first depths are right.
  bool learns_lens_from_first_depths() const { return progress().checking && adjusts_lens(); }

  /// While a start without a target is under way: records the frame's pixels, and restarts the filter when the record gives better depths.
  /// After one at a target, or before walls: likewise, until the record shows that the filter's depths are right, or wrong. True: they were
  /// wrong, and places and poses of before no longer hold.
  bool record_frame();
  /// Begins an empty record with the features that this frame has added.
  void begin_record();
  /// The camera has been at rest since begin_ns. The first time that samples can tell the scale from here on: true, and gravity and biases
  /// are known. A map whose scale is unknown begins anew with this frame.
  bool use_rest(const RestReading& rest, std::int64_t begin_ns);
  /// Likewise of a camera that moves: the map goes on in metres, under another id.
  bool use_motion(const MovingSolution& solution);
  /// A map that samples may scale, once its depths are known: of unknown scale, and not too old for it.
  bool may_become_metric() const;
  /// The next map begins with the unit's mounting and its delay as they are known now, and not with those of the config.
  void keep_mounting();
  /// Where the unit is on the camera, as far as it is known.
  Mounting mounting() const;
  /// Nothing in the map has been compared with the walls of the plan yet (filter_start_away.cpp).
  bool has_walls_apart() const { return parts_.map.planes.has_apart(); }
  /// Where most points that this frame saw before such walls have one ratio of distances in common: the map gets the size that the plan
  /// says, and the walls count from now on. Returns the factor; 0: not yet.
  Scalar look_for_walls();
  /// Ends a record, where something else tells the depths from now on.
  void end_record() { without_.init(); }

 private:
  /// The lens of a start without a target is estimated with its depths, and not only considered.
  bool adjusts_lens() const { return settings_.lens.rows.shape_count() > 0 && settings_.body.considered_rows() == 0; }
  bool is_recording() const { return progress().recording || progress().checking; }
  void set_body(const Body& body, const Scalar* known, const Scalar* J_lens = nullptr);
  bool may_begin_anew(std::int64_t begin_ns) const;
  bool needs_record() const;
  bool sees_walls() const;
  void keep_walls_apart();
  void open_scale();
  void scale_tables(Scalar scale, const Vec3& pivot);
  void set_start_velocities(Scalar speed);
  void note_covariance();
  void set_known_pose(bool at_target, bool fitted_to_target = false);
  void begin_body(const Body& body, bool fitted_to_target);
  bool check_depths(bool settled);
  Scalar unit_of_record() const;
  Scalar unit_by_walls() const;
  bool most_depths_agree(Scalar unit) const;
  bool motion_agrees(Scalar unit) const;
  void empty_filter();
  void clear_all_but_walls();
  void stay_at_base();
  void begin_anew();
  void bound_baseline();
  void restart_from_record(Scalar unit);
  template <typename Rho>
  void restart_features(Rho&& rho_of, Scalar relative_sigma);
  void restart_frame(int k, std::int64_t before_ns, Scalar unit);
  void restart_velocities(Scalar unit);
  void restart_at_target();

  /// What is kept between frames.
  struct Data {
    KnownBody known;
    bool has_place = false;     ///< the caller said where in W the start is
    bool knows_scale = false;   ///< a target, walls or a known speed tell it
    bool from_motion = false;   ///< lengths are in metres since the samples of a moving camera told them
    std::int64_t begin_ns = 0;  ///< when the body got its first pose
    Scalar covariance[BodyLayout::kVelocityRows * BodyLayout::kVelocityRows] = {};  ///< of the body at the first frame
  };

  /// How the unit is mounted, and the covariance of those rows.
  struct KnownMounting {
    static constexpr int kRows = 7;
    Mounting mounting;
    Scalar covariance[kRows * kRows];
  };

  void forget_mounting();
  const Mounting& known_mounting() const {
    return mounting_ != nullptr ? mounting_->mounting : settings_.unit.mounting;
  }

  const Settings& settings_;
  const BodyMotion& motion_;
  const StartedParts parts_;
  KnownMounting* mounting_ = nullptr;  ///< that maps begin with; null where it is constant, that of the settings
  Data data_;
  StartAtTarget target_;
  StartWithoutTarget without_;
};

}  // namespace pf
