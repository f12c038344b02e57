#pragma once

#include <cstdint>

#include "frame/frame.h"
#include "frame/noise_model.h"
#include "frame/settings.h"
#include "frame/tracking_state.h"
#include "map/map.h"
#include "model/state.h"

/// Read-only view of a session: state, pose, features, planes, matches, report. Only this class knows which back end it reads.

namespace pf {

class FilterSlam;
class Filter;
class KeyframeSlam;

/// Current estimate of a feature.
struct FeatureView {
  std::uint32_t id, external_id;
  bool is_target;
  int observations, attempts;
  BlockKind kind;
  std::uint32_t plane;  ///< id of the plane that it lies on, or 0
  Vec3 p_W;
  Mat3 covariance;
};

/// Current estimate of a plane. The third axis of its frame P is the normal.
struct PlaneView {
  std::uint32_t id;
  int points, fixed_points;
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

/// What is known of the inertial unit and of gravity.
struct InertialView {
  Vec3 gravity_W, gyro_bias, accel_bias;
  Vec3 axis_W[2];           ///< about which gravity's error rotates it
  Scalar covariance[8][8];  ///< of (gravity, gyro bias, accelerometer bias)
  bool metric, from_motion, resting;
  int rests;
  Quat q_BC;
  Vec3 p_BC;
  double delay_s, readout_s;
  Scalar sigma[17];  ///< as pf_inertial_t says
};

/// A patch on a wall in the last frame.
struct PatchView {
  std::uint32_t id, plane;
  int status;  ///< pf_match_status_t, or 0
  int frames;
  const Vec2* corner;                             ///< four [px]
  const Eigen::Matrix<Scalar, 8, 8>* covariance;  ///< [px^2]
  Scalar weight;
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
  int features = 0, points = 0, inverse_depths = 0, folded = 0, fixed = 0;
  int planes = 0;
  int patches = 0, cameras = 0, keyframes = 0;
  int state_dim = 0, state_dim_held = 0;
  int state_dim_points_only = 0;  ///< rows of the same map without planes
};

class View {
 public:
  View(const Settings& settings, const Map& map, const FilterSlam& loop);
  View(const Settings& settings, const Map& map, const KeyframeSlam& window);

  // view.cpp
  bool used() const;
  std::int64_t last_ns() const;
  SlamState state() const;
  bool has_pose() const;
  std::uint32_t map_id() const;
  int kept_views() const;
  /// The calibration as it is known now, and the covariance of its parameters; zero where they are exact.
  const Camera& lens(Scalar covariance[kLensParameters][kLensParameters]) const;
  /// Body and pose covariance (6x6) at the last frame, or predicted to a later time.
  void pose_at(std::int64_t t_ns, Body* body, Mat6* covariance) const;
  /// False without the inertial motion model, or without a pose.
  bool inertial(InertialView* out) const;
  /// Whether pictures contradict the inertial unit, and for how long they have in all.
  bool unit_doubted() const;
  std::int64_t unit_doubted_ns() const;
  /// False if there is no mark in this map.
  bool motion_since_mark(MotionView* out) const;
  /// Projects a known point; covariance may be null. False if the point does not project.
  bool project(const Vec3& p_W, Vec2* pixel, Mat2* covariance) const;
  const FrameReport& report() const;
  const NoiseModel& noise() const;
  int match_count() const;
  const Match& match(int i) const;
  MapCounts counts() const;
  int state_dim() const;
  /// scratch: state_dim * (state_dim + 8)
  bool gauge_information(double* scratch, double* information) const;

  /// Rows of the tables; some are free.
  int feature_capacity() const { return map_.features.capacity(); }
  bool has_feature(int i) const { return map_.features.used(i); }
  FeatureView feature(int i) const;
  /// False without masks, and where no feature has this id.
  bool template_of(std::uint32_t id, TemplateView* out) const;
  int plane_capacity() const { return map_.planes.capacity(); }
  bool has_plane(int i) const { return map_.planes.used(i); }
  /// Current id of the plane that once had this id; 0 if there is none.
  std::uint32_t find_plane(std::uint32_t id) const { return map_.planes.find(id); }

  /// Rows of the store of patches; some are free.
  int patch_capacity() const;
  bool has_patch(int i) const;
  PatchView patch(int i) const;

  // view_planes.cpp
  PlaneView plane(int i) const;
  /// Of a plane, given_W or, where that is zero, the state's gravity.
  TiltView tilt(int i, const PlaneView& plane, const Vec3& given_W) const;
  /// Nearest plane whose outline the ray of a pixel hits; plane 0 if there is none. False if the pixel has no ray.
  bool hit(const Vec2& pixel, HitView* hit) const;

 private:
  const Filter& filter() const;
  void describe_mounting(InertialView* out) const;
  bool surface_of(int i, const Vec3& viewer_W, Vec3* normal_W) const;

  // view_window.cpp: the same of the window
  void window_pose_at(std::int64_t t_ns, Body* body, Mat6* covariance) const;
  bool window_motion_since_mark(MotionView* out) const;
  bool window_project(const Vec3& p_W, Vec2* pixel, Mat2* covariance) const;
  FeatureView window_feature(int i) const;
  bool window_surface_of(int i, const Vec3& viewer_W, Vec3* normal_W) const;
  const Camera& window_lens(Scalar covariance[kLensParameters][kLensParameters]) const;
  MapCounts window_counts() const;
  PlaneView window_plane(int i) const;
  bool window_hit(const Vec2& pixel, HitView* hit) const;

  const Settings& settings_;
  const Map& map_;
  const Frame& frame_;
  const TrackingState& tracking_;
  const NoiseModel& noise_;
  const FilterSlam* loop_ = nullptr;  ///< one of these two is null
  const KeyframeSlam* window_ = nullptr;
};

}  // namespace pf
