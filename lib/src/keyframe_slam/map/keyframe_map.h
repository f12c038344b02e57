#pragma once

#include "frame/frame.h"
#include "frame/settings.h"
#include "keyframe_slam/map/keyframe_table.h"
#include "keyframe_slam/map/lens.h"
#include "map/map.h"
#include "memory/place_table.h"

/// Points and keyframes of the window. A point is a bearing and an inverse depth in the keyframe that saw it first, its host.

namespace pf {

class Archive;

/// A point of the window, beside its row in the feature table, with the same number.
struct KeyframePoint {
  int host = -1;  ///< keyframe
  Vec3 ray_K = Vec3::UnitZ();
  Scalar rho = 0;                ///< [1/m] along ray_K, which has length 1
  Scalar variance = 0;           ///< of rho, keyframes taken as exact
  bool has_depth = false;        ///< rho was triangulated, or is the target's
  bool faces_host = false;       ///< its appearance is the host's
  std::int8_t plane = -1;        ///< entry of the plane that it lies on, or -1
  RhoPrior remembered = {0, 0};  ///< of a point that a place or a plan has put where it is: what that knew of rho
  Vec2 pixel = Vec2::Zero();     ///< where it was last seen, and from where
  CameraView seen_from;
};

class KeyframeMap {
 public:
  KeyframeMap(const Settings& settings, Map& map, Frame& frame) : settings_(settings), map_(map), frame_(frame) {}

  bool layout(Arena& arena);
  void init();
  /// Removes all points, planes and keyframes. Walls of a plan stay as they were when they came, and places of other maps.
  void clear();

  KeyframeTable keyframes;
  PlaceTable places;

  /// As it is known now.
  const Camera& camera() const { return lens_.camera(); }
  KeyframeLens& lens() { return lens_; }
  const KeyframeLens& lens() const { return lens_; }
  /// Another estimate of the lens: bearings become those of the same pixels of their hosts, and with another readout pixels those of their
  /// frames' times by it. Points of the target stay where they are.
  void move_lens(const Camera& camera);
  /// Ray of a point in its host, by the present lens.
  HostPixel host_pixel(int i) const;

  int capacity() const { return map_.features.capacity(); }
  bool used(int i) const { return map_.features.used(i); }
  KeyframePoint& point(int i) { return point_[i]; }
  const KeyframePoint& point(int i) const { return point_[i]; }
  Feature& feature(int i) { return map_.features[i]; }
  const Feature& feature(int i) const { return map_.features[i]; }
  Map& tables() { return map_; }
  const Map& tables() const { return map_; }

  /// Bearing in W, of length 1.
  Vec3 ray_W(int i) const { return keyframes[point_[i].host].q_WC * point_[i].ray_K; }
  /// Of a point with a depth.
  Vec3 position(int i) const { return keyframes[point_[i].host].p_W + ray_W(i) / point_[i].rho; }
  /// Of its position, keyframes taken as exact: along the ray by the depth, across it by a pixel of the host.
  Mat3 covariance(int i) const;
  BlockKind kind(int i) const;
  /// Median depth of this frame's inliers that have one, seen from a pose; 0 without any.
  Scalar median_depth(const Quat& q_WC, const Vec3& p_W) const;
  /// Room within one call, one of each for each point. median_depth() uses the numbers.
  struct Scratch {
    Scalar* number = nullptr;
    Vec3* vector = nullptr;
  };
  const Scratch& scratch() const { return scratch_; }

  /// Adds a point without a depth at a pixel of a keyframe; evicts one that was not seen in this frame where there is no room. Returns its
  /// row, or -1.
  int add(int host, const Vec2& pixel);
  /// Sets bearing and inverse depth of a point in its host.
  void place(int i, const Vec3& p_W);
  void drop(int i);

  void carry(Archive& archive);  ///< base/archive.h

 private:
  const Settings& settings_;
  Map& map_;
  Frame& frame_;
  KeyframeLens lens_;
  KeyframePoint* point_ = nullptr;
  Scratch scratch_;
};

}  // namespace pf
