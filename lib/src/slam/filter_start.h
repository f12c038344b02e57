#pragma once

#include "base/status.h"
#include "filter/filter.h"
#include "map/map.h"
#include "slam/body_motion.h"
#include "slam/feature_keeper.h"
#include "slam/frame.h"
#include "slam/image_front_end.h"
#include "slam/pixel_update.h"
#include "slam/settings.h"
#include "slam/start.h"
#include "slam/start_at_target.h"
#include "slam/start_without_target.h"
#include "slam/tracking_state.h"

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
  /// A filter without a map, of which nothing is known.
  void clear_filter();
  /// Everything that came from the estimate goes, and what the caller said of the first pose, which is not true here. A target that is
  /// still there may be found again.
  void start_over();

  /// Whether a start at this target can be made with these capacities.
  bool fits(const Target& target) const;
  Status use_target(const Target& target);
  Status use_pose(const KnownBody& known);
  /// A rectangle is found in images; there is no such thing in a list of observations.
  bool takes_images_only() const { return target_.target().kind == TargetKind::kRectangle; }

  /// The pose at the first frame. False: not yet.
  bool start_in_image();
  void start_with_observations();
  const StartProgress& progress() const { return without_.progress(); }

  /// Of a start without a target that is under way: the frame's pixels are recorded, and the filter begins again when they explain more.
  void record_frame();
  /// The features that this frame has added become those of a record that has none.
  void begin_record();

 private:
  void set_body(const Body& body, const Scalar* covariance);
  void set_known_pose();
  Vec2 at_frame_time(int slot, const Vec2& measured) const;
  void restart_from_record();
  void restart_features();
  void restart_frame(int k, std::int64_t before_ns);
  void restart_velocities();

  /// What is kept between frames.
  struct Data {
    KnownBody known;
    Scalar covariance[Body::kMaxDim * Body::kMaxDim] = {};  ///< of the body at the first frame
  };

  const Settings& settings_;
  const BodyMotion& motion_;
  const StartedParts parts_;
  Data data_;
  StartAtTarget target_;
  StartWithoutTarget without_;
};

}  // namespace pf
