#pragma once

#include "base/arena.h"
#include "frame/start/start.h"
#include "track/quad_refine.h"
#include "track/tracker.h"

/// Start at a known target: finds it in an image and computes the camera's pose from it. Knows no filter.

namespace pf {

class Archive;

/// A target as an image shows it.
struct TargetSighting {
  PoseEstimate pose;
  Vec2 pixel[Target::kMaxPoints];  ///< of each point of the target
};

class StartAtTarget {
 public:
  bool layout(Arena& arena, int width, int height);
  void init() {
    target_ = Target();
    has_begun_ = false;
  }

  void set_target(const Target& target) { target_ = target; }
  const Target& target() const { return target_; }
  bool has_target() const { return target_.kind != TargetKind::kNone; }

  /// Whether a map may begin at the target in an image. The pose that comes with points is that of the first frame: where the
  /// camera is after it has been lost, nobody knows, and strong corners near those pixels are chance.
  bool is_expected() const { return has_target() && !(has_begun_ && target_.kind == TargetKind::kPoints); }
  /// A map begins in an image, at the target or without it.
  void note_begin() { has_begun_ = true; }

  /// Finds the target in the image, and keeps the pose that was found as the target's first pose. False: not found.
  bool find(const Camera& camera, const Tracker& tracker, TargetSighting* sighting);

  void carry(Archive& archive);  ///< base/archive.h

 private:
  void put_in_place(TargetSighting* sighting);
  bool find_rectangle(const Camera& camera, const Tracker& tracker, TargetSighting* sighting) const;
  bool find_points(const Camera& camera, const Tracker& tracker, TargetSighting* sighting) const;
  bool predict_points(const Camera& camera, Vec2* predicted, Scalar* reach, Scalar* distance) const;
  bool match_quad(const Quad& quad, const Vec2* predicted, const Scalar* reach, Vec2* z) const;
  bool fit(const Camera& camera, const Vec2* z, Scalar sigma_px, TargetSighting* sighting) const;

  Target target_;  ///< kept between frames
  bool has_begun_ = false;
  QuadWorkspace quad_workspace_;
};

}  // namespace pf
