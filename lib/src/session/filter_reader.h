#pragma once

#include <cstdint>

#include "frame/settings.h"
#include "map/map.h"
#include "session/shown.h"

/// Reads what a view shows from the filter back end.

namespace pf {

class Filter;
class FilterSlam;

class FilterReader {
 public:
  FilterReader(const Settings& settings, const Map& map, const FilterSlam& slam);

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

  /// Of a plane against the state's gravity.
  TiltView tilt(int i) const;

 private:
  const Settings& settings_;
  const Map& map_;
  const FilterSlam& slam_;
  const Filter& filter_;
};

}  // namespace pf
