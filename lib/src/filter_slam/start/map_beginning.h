#pragma once

#include <cstdint>

#include "filter/filter.h"
#include "frame/frame.h"
#include "frame/settings.h"
#include "frame/start/start.h"
#include "frame/tracking_state.h"
#include "inertial/body_motion.h"
#include "inertial/kept_mounting.h"
#include "map/map.h"

/// Begins a map in the filter: empties it, and sets the first body with its covariance.

namespace pf {

class Archive;

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

  /// Sets the caller's body of the first frame.
  const KnownBody& known() const { return data_.known; }
  void use(const KnownBody& known);
  /// Drops the caller's body, which belongs to the first map only.
  void forget_known() { data_.known = KnownBody(); }
  /// Whether the caller's velocity is large enough, and certain enough, to fix the scale.
  bool has_known_speed() const;
  /// Time at which the map got its first pose.
  std::int64_t begin_ns() const { return data_.begin_ns; }

  /// Empties the filter, and with it the table of planes.
  void clear_filter();
  /// Empties the filter but for the walls of the plan, which get their priors again.
  void clear_all_but_walls();

  /// Sets the filter's body for a map's first frame: the caller's, else that of a target, else the one that defines W. target: where the
  /// map begins at one; else null. fitted: its pose was fitted to pixels of this frame.
  void begin(const Target* target, bool fitted);
  /// Sets the filter's body, with the covariance of the first frame's. fitted_to: the target to whose pixels the pose was fitted, so that
  /// it depends on the lens; null: it does not.
  void begin_at(const Body& body, const Target* fitted_to);
  /// The same for a camera that may be anywhere. depth: median, of what it sees.
  void begin_anywhere(const Quat& q_WC, const Vec3& p_W, Scalar depth);
  /// From here on begin_at() uses the present covariance of the pose. Velocities are unknown, and replaced by those of a record.
  void note_covariance();

  void carry(Archive& archive);  ///< base/archive.h

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
