#pragma once

#include <cstdint>

#include "map/plane_outline.h"
#include "model/block.h"
#include "vision/patch.h"
#include "vision/planar_template.h"

/// What a view shows of a session: plain values, the same for both back ends.

namespace pf {

/// Current estimate of a feature.
struct FeatureView {
  std::uint32_t id, external_id;
  bool is_target;
  int observations, attempts;
  BlockKind kind;
  std::uint32_t plane;  ///< id of the plane that it lies on, or 0
  bool on_trial;        ///< it began on that plane, and its own parallax has not confirmed it yet
  Scalar log_odds;      ///< that it is a point of the scene
  Vec3 p_W;
  Mat3 covariance;
};

/// Current estimate of a plane. The third axis of its frame P is the normal.
struct PlaneView {
  std::uint32_t id;
  int points, fixed_points;
  int trial;            ///< of `points`, those that began on it and are on trial
  bool known, doubted;  ///< a wall, and one that its points contradict
  Vec3 normal_W;
  Scalar distance;
  Mat3 R_WP;
  Vec3 p_WP;
  Mat3 covariance;       ///< of two rotations about the first axes of P, and of the distance
  PlaneOutline outline;  ///< in P
};

/// How a plane lies against gravity.
struct TiltView {
  bool known = false;     ///< whether gravity is
  Scalar up = 0;          ///< cosine of the angle from up to the normal
  Scalar sigma_up = 0;    ///< of `up`
  Scalar sigma_tilt = 0;  ///< of the angle between the normal and gravity's line, where that is small, in all [rad]
};

/// Motion of the camera from the mark to the last frame: its pose now in the frame K of the camera then.
struct MotionView {
  std::int64_t mark_ns;
  Quat q_KC;
  Vec3 p_KC;
  Mat6 covariance;  ///< of (theta, p) in K
};

/// Intersection of a ray with a plane.
struct HitView {
  std::uint32_t plane = 0;
  Scalar range = 0;
  Vec3 p_W = Vec3::Zero();
  Mat3 covariance = Mat3::Zero();
};

/// Template of a feature, with masks.
struct TemplateView {
  const PlanarTemplate* shape;
  const std::uint8_t* mask;
  const SourcePatch* patch;
  Vec3 normal_W;        ///< towards the camera
  Scalar sigma_normal;  ///< [rad] 0 of a folded feature's, which is its plane's

  std::uint8_t grey(int x, int y) const;
};

/// Numbers of features by kind, of planes and of rows.
struct MapCounts {
  int features = 0, points = 0, inverse_depths = 0, folded = 0, fixed = 0, trial = 0;
  int planes = 0;
  int patches = 0, cameras = 0, keyframes = 0;
  int places = 0, places_returned = 0;
  int state_dim = 0, state_dim_held = 0;
  int state_dim_points_only = 0;  ///< rows of the same map without planes
};

}  // namespace pf
