#pragma once

#include <cstdint>

#include "filter/state.h"
#include "map/map.h"
#include "slam/frame.h"
#include "slam/settings.h"
#include "slam/tracking_state.h"

/// All that can be read from a session: state, pose, features, planes, matches, report. It changes nothing, and it alone knows which
/// back end is asked.

namespace pf {

class FrameLoop;
class Filter;

/// A feature as it is now.
struct FeatureView {
  std::uint32_t id, external_id;
  bool is_target;
  int observations, attempts;
  BlockKind kind;
  std::uint32_t plane;  ///< id of the plane that it lies on, or 0
  Vec3 p_W;
  Mat3 covariance;
};

/// A plane as it is now, in a frame P that has it as third axis.
struct PlaneView {
  std::uint32_t id;
  int points, fixed_points;
  Vec3 normal_W;
  Scalar distance;
  Mat3 R_WP;
  Vec3 p_WP;
  Mat3 covariance;       ///< of two rotations about the first axes of P, and of the distance
  PlaneOutline outline;  ///< in P
};

/// Where a ray meets a plane.
struct HitView {
  std::uint32_t plane = 0;
  Scalar range = 0;
  Vec3 p_W = Vec3::Zero();
  Mat3 covariance = Mat3::Zero();
};

/// What the map holds, by kind.
struct MapCounts {
  int features = 0, points = 0, inverse_depths = 0, folded = 0, fixed = 0;
  int planes = 0;
  int state_dim = 0, state_dim_held = 0;
  int state_dim_points_only = 0;  ///< what the same map would need without planes
};

class View {
 public:
  View(const Settings& settings, const Map& map, const FrameLoop& loop) : settings_(settings), map_(map), loop_(loop) {}

  // view.cpp
  bool used() const;
  std::int64_t last_ns() const;
  SlamState state() const;
  bool has_pose() const;
  /// Body and pose covariance (6x6) at the last frame, or predicted to a later time.
  void pose_at(std::int64_t t_ns, Body* body, Mat6* covariance) const;
  /// Pixel of a known point, and its covariance where that is not null. False where it does not project.
  bool project(const Vec3& p_W, Vec2* pixel, Mat2* covariance) const;
  const FrameReport& report() const;
  int match_count() const;
  const Match& match(int i) const;
  MapCounts counts() const;
  int state_dim() const;
  /// scratch: state_dim * (state_dim + 8)
  bool gauge_information(double* scratch, double* information) const;

  /// Entries of the tables, some of them free.
  int feature_capacity() const { return map_.features.capacity(); }
  bool has_feature(int i) const { return map_.features.used(i); }
  FeatureView feature(int i) const;
  int plane_capacity() const { return map_.planes.capacity(); }
  bool has_plane(int i) const { return map_.planes.used(i); }
  /// The id that a plane's id stands for now; 0 when it is gone.
  std::uint32_t find_plane(std::uint32_t id) const { return map_.planes.find(id); }

  // view_planes.cpp
  PlaneView plane(int i) const;
  /// The nearest plane that the ray of a pixel meets within its outline; plane 0 where there is none. False: the pixel has no ray.
  bool hit(const Vec2& pixel, HitView* hit) const;

 private:
  const Filter& filter() const;

  const Settings& settings_;
  const Map& map_;
  const FrameLoop& loop_;
};

}  // namespace pf
