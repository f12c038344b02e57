#pragma once

#include <cstdint>

#include "filter/filter.h"
#include "filter_slam/pose/body_motion.h"
#include "filter_slam/start/kept_mounting.h"
#include "frame/frame.h"
#include "frame/settings.h"
#include "frame/start/start.h"
#include "frame/tracking_state.h"
#include "map/map.h"

/// How a map begins in the filter: empties it, and gives it the first body with what is known of that.

namespace pf {

class MapBeginning {
 public:
  MapBeginning(const Settings& settings, const BodyMotion& motion, const KeptMounting& mounting, Filter& filter,
               Map& map, const Frame& frame, TrackingState& tracking)
      : settings_(settings),
        motion_(motion),
        mounting_(mounting),
        filter_(filter),
        map_(map),
        frame_(frame),
        tracking_(tracking) {}

  void init() { data_ = Data(); }

  /// The body of the first frame, as the caller knows it.
  const KnownBody& known() const { return data_.known; }
  void use(const KnownBody& known);
  /// What the caller knew of the first frame's body does not hold for the next map.
  void forget_known() { data_.known = KnownBody(); }
  /// Whether the caller's velocity is large enough, and certain enough, to tell the scale.
  bool has_known_speed() const;
  /// Time at which the map got its first pose.
  std::int64_t begin_ns() const { return data_.begin_ns; }

  /// Empties the filter, and with it the table of planes.
  void clear_filter();
  /// Empties the filter but for the walls of the plan, which are in it again as they were given.
  void clear_all_but_walls();

  /// Gives the filter the body of a map's first frame: the one that the caller knows, else that of a target, else the one that defines W.
  /// target: where the map begins at one; else null. fitted: its pose was fitted to pixels of this frame.
  void begin(const Target* target, bool fitted);
  /// Gives the filter this body, as uncertain as that of the first frame. fitted_to: the target whose pixels the pose was fitted to: the
  /// pose is wrong where the lens is; null where it does not depend on the lens.
  void begin_at(const Body& body, const Target* fitted_to);
  /// From here on begin_at() uses the covariance of the pose as it is now. Velocities are unknown: those of a record replace them.
  void note_covariance();

 private:
  void leave_anchors();
  void empty_filter();
  void set_body(const Body& body, const Scalar* known, const Scalar* J_lens = nullptr);
  void set_initial_velocities(Scalar speed);

  /// What is kept between frames.
  struct Data {
    KnownBody known;
    std::int64_t begin_ns = 0;
    Scalar covariance[BodyLayout::kVelocityRows * BodyLayout::kVelocityRows] = {};  ///< of the body at the first frame
  };

  const Settings& settings_;
  const BodyMotion& motion_;
  const KeptMounting& mounting_;
  Filter& filter_;
  Map& map_;
  const Frame& frame_;
  TrackingState& tracking_;
  Data data_;
};

}  // namespace pf
