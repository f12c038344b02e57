#pragma once

#include <cstdint>

#include "frame/settings.h"
#include "map/map.h"
#include "session/shown.h"

/// Reads what a view shows from the keyframe back end.

namespace pf {

class KeyframeSlam;

class KeyframeReader {
 public:
  KeyframeReader(const Settings& settings, const Map& map, const KeyframeSlam& slam)
      : settings_(settings), map_(map), slam_(slam) {}

  // --- as declared in View
  int kept_views() const;
  /// Sets the part of the covariance that is not zero.
  const Camera& lens(Scalar covariance[kLensParameters][kLensParameters]) const;
  void pose_at(std::int64_t t_ns, Body* body, Mat6* covariance) const;
  bool motion_since_mark(MotionView* out) const;
  bool project(const Vec3& p_W, Vec2* pixel, Mat2* covariance) const;
  MapCounts counts() const;
  PlaneView plane(int i) const;
  bool hit(const Vec2& pixel, HitView* hit) const;

  /// Sets kind, plane, place and covariance of a feature.
  void place_feature(int i, FeatureView* out) const;
  /// Normal of the plane that a feature lies on, towards a viewer. False where it lies on none.
  bool surface_of(int i, const Vec3& viewer_W, Vec3* normal_W) const;

 private:
  int newest_host_on(int i) const;
  Mat3 plane_with_keyframe(int i) const;

  const Settings& settings_;
  const Map& map_;
  const KeyframeSlam& slam_;
};

}  // namespace pf
