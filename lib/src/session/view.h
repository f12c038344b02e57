#pragma once

#include <cstdint>

#include "frame/frame.h"
#include "frame/noise_model.h"
#include "frame/settings.h"
#include "frame/tracking_state.h"
#include "map/map.h"
#include "memory/map_bytes.h"
#include "session/inertial_view.h"
#include "session/shown.h"
#include "track/patch_store.h"

/// Read-only view of a session. Only this class knows which back end it reads.

namespace pf {

class FilterSlam;
class KeyframeSlam;

class View {
 public:
  View(const Settings& settings, const Map& map, const FilterSlam& slam);
  View(const Settings& settings, const Map& map, const KeyframeSlam& slam);

  // --- what both back ends keep
  const Map& map() const { return map_; }
  const Frame& frame() const { return frame_; }
  const TrackingState& tracking() const { return tracking_; }
  const NoiseModel& noise() const { return noise_; }
  /// Whether there has been a frame, and its time.
  bool used() const { return frame_.report.frames > 0; }
  std::int64_t last_ns() const { return frame_.report.t_ns; }

  // --- what both back ends estimate
  int kept_views() const;
  /// The calibration as it is known now, and the covariance of its parameters; zero where they are exact.
  const Camera& lens(Scalar covariance[kLensParameters][kLensParameters]) const;
  /// Body and pose covariance (6x6) at the last frame, or predicted to a later time.
  void pose_at(std::int64_t t_ns, Body* body, Mat6* covariance) const;
  /// False if there is no mark in this map.
  bool motion_since_mark(MotionView* out) const;
  /// Writes the map (MapSaving::save). kState: there is nothing to save, or the back end cannot.
  Status save_map(const Vec3& gravity_W, MapWriter* out) const;
  /// Projects a known point; covariance may be null. False if the point does not project.
  bool project(const Vec3& p_W, Vec2* pixel, Mat2* covariance) const;
  MapCounts counts() const;
  /// Of a row of the table that is in use; so is that of plane().
  FeatureView feature(int i) const;
  PlaneView plane(int i) const;
  /// Of a plane against given_W or, where that is zero, against the state's gravity.
  TiltView tilt(int i, const PlaneView& plane, const Vec3& given_W) const;
  /// Nearest plane whose outline the ray of a pixel hits; plane 0 if there is none. False if the pixel has no ray.
  bool hit(const Vec2& pixel, HitView* hit) const;
  /// False without masks, and where no feature has this id.
  bool template_of(std::uint32_t id, TemplateView* out) const;

  // --- of the filter alone
  /// True where there is a state with a covariance.
  bool has_state() const { return filter_ != nullptr && tracking_.has_pose(); }
  /// False without the inertial motion model, or without a pose.
  bool inertial(InertialView* out) const;
  /// Whether images contradict the inertial unit, and for how long they have in all.
  UnitDoubt unit_doubt() const;
  /// scratch: n (n + 8), of n = MapCounts::state_dim. Needs a state.
  bool gauge_information(double* scratch, double* information) const;
  /// Null where there is no room for patches.
  const PatchStore* patches() const;

 private:
  template <typename F>
  decltype(auto) read(F&& f) const;

  const Settings& settings_;
  const Map& map_;
  const Frame& frame_;
  const TrackingState& tracking_;
  const NoiseModel& noise_;
  const FilterSlam* filter_ = nullptr;  ///< one of these two is null
  const KeyframeSlam* keyframes_ = nullptr;
};

}  // namespace pf
