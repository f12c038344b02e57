#pragma once

#include <cstdint>

#include "bundle/adjust.h"
#include "frame/noise_model.h"
#include "frame/start/start.h"
#include "keyframe_slam/map/keyframe_map.h"
#include "keyframe_slam/planes/planes.h"

/// Adjusts keyframes and the points that they see, with a few older keyframes that see the same points held fixed. Points on a plane are
/// held to it, and the plane is adjusted with them; so is the lens, where the settings say that it is uncertain.

namespace pf {

class KeyframeAdjustment {
 public:
  KeyframeAdjustment(const Settings& settings, KeyframeMap& map, KeyframePlanes& planes, const NoiseModel& noise)
      : settings_(settings), map_(map), planes_(planes), noise_(noise) {}

  bool layout(Arena& arena);
  void init() {
    map_covariance_.setZero();
    target_ = Target();
  }

  /// Adjusts all keyframes of a map that is settled, with the lens where the settings let it be estimated; before, while a record of its
  /// start goes on, the newest ones with the lens as it is. False: there is nothing to adjust yet.
  bool run(bool settled);
  /// Of the newest keyframe's (theta, p) in W, and with it of the map about it, given the map's first keyframe.
  const Mat6& map_covariance() const { return map_covariance_; }
  /// The map's lengths were multiplied by s.
  void scale(Scalar s) {
    map_covariance_.bottomRows<3>() *= s;
    map_covariance_.rightCols<3>() *= s;
  }
  /// The target's points are where it says from now on. seen_from: any pose in front of them.
  void hold_target(const CameraView& seen_from, const Target& target) {
    target_view_ = seen_from;
    target_ = target;
  }

 private:
  bool is_held_by_target() const;
  int choose_free(bool settled);
  int choose_points(int free);
  bool hold_distance(int free, int seen_in, BundleDistance* held) const;
  int choose_fixed(int free, int points, bool settled);
  int pose_of(int keyframe, int* poses);
  void fill(int seen_in, int points, int* poses);
  void add_target(int points, int* poses);
  void put_target_back();
  int add_plane_points(int points);
  bool fits_plane(const BundlePlane& plane, int i) const;
  int add_planes(int points);
  void hold_by_pixels(int first, int points);
  void note_covariance(const Mat6& given_held, int free, int seen_in);
  void take_back(int free, int points);
  void take_planes_back(int planes, bool determined);
  void reject_outliers(int i);

  const Settings& settings_;
  KeyframeMap& map_;
  KeyframePlanes& planes_;
  const NoiseModel& noise_;
  BundleAdjuster adjuster_;
  Mat6 map_covariance_ = Mat6::Zero();
  CameraView target_view_;
  Target target_;
  int max_free_ = 0;  ///< keyframes that are adjusted at once

  // Keyframes that hang together with the newest one.
  bool* is_connected_ = nullptr;
  bool* is_seen_ = nullptr;  ///< points, by one of them
  int connected_ = 0;
  bool is_away_ = false;  ///< the map's first keyframe is not one of them

  // Of the bundle.
  BundlePose* pose_ = nullptr;
  int* keyframe_ = nullptr;  ///< of each pose, -1 of the target's host
  BundlePixel* pixel_ = nullptr;
  Vec3* ray_ = nullptr;
  int* host_ = nullptr;
  Scalar* rho_ = nullptr;
  Scalar* rho_before_ = nullptr;
  RhoPrior* prior_ = nullptr;
  std::int16_t* row_ = nullptr;  ///< of each point in the map
  BundlePlane* plane_ = nullptr;
  int* plane_row_ = nullptr;         ///< of each plane in the table
  int* plane_of_ = nullptr;          ///< plane of each point, or -1
  HostPixel* host_pixel_ = nullptr;  ///< null where the lens is exact
};

}  // namespace pf
