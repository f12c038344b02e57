#pragma once

#include <cstdint>

#include "base/eigen.h"
#include "vision/appearance.h"
#include "vision/descriptor.h"

/// A place: a camera that has left the window, with what is known of the points that it saw (lib/docs/theory/places.md).

namespace pf {

/// The image around a point where it was first seen: the middle of its SourcePatch at full resolution.
struct PlacePatch {
  static constexpr int kSize = 22;
  float centre[2] = {0, 0};                 ///< where the point is in the patch [px]
  std::uint8_t begin[2] = {}, end[2] = {};  ///< what of it is inside the image
  std::uint8_t pixels[kSize * kSize] = {};
};

/// Ordered by size, since there are many.
struct PlacePoint {
  std::uint32_t id = 0;     ///< of the feature
  std::uint32_t plane = 0;  ///< id of the plane that it lies on, 0: none
  std::int32_t observations = 0;
  float ray_K[3] = {0, 0, 1};                 ///< of length 1
  float rho = 0;                              ///< [1/m] along it
  float covariance[6] = {};                   ///< of its position in K, the camera taken as exact: lower triangle [m^2]
  float q_KV[4] = {1, 0, 0, 0}, c_K[3] = {};  ///< the view that its patch is from: w x y z, and centre [m]
  Descriptor descriptor;
  PlacePatch patch;

  Vec3 ray() const {
    return Vec3(static_cast<Scalar>(ray_K[0]), static_cast<Scalar>(ray_K[1]), static_cast<Scalar>(ray_K[2]));
  }
  Vec3 position_K() const { return ray() / static_cast<Scalar>(rho); }
  Mat3 covariance_K() const;
};

struct KeptPlace {
  static constexpr int kMaxPoints = 24;

  std::uint32_t id = 0;      ///< number of the keyframe that it was; 0: this entry is free
  std::uint32_t map_id = 0;  ///< of another map that it belongs to, where W is another one; 0: of the present one
  bool is_back = false;      ///< its points are those of the back end: of the window, or of the state
  int count = 0;             ///< points
  Scalar depth = 1;          ///< of them, median [m]
  Quat q_WK = Quat::Identity();
  Vec3 p_WK = Vec3::Zero();
  Mat6 covariance = Mat6::Zero();  ///< of (theta, p) in W
  PlacePoint point[kMaxPoints];

  Vec3 position_W(int i) const { return p_WK + q_WK * point[i].position_K(); }
};

/// Sets where a point is in K, with the covariance of that, and its appearance, in which V saw it first: q_KV, c_K.
void set_place_point(const Vec3& x_K, const Mat3& covariance_K, const Quat& q_KV, const Vec3& c_K,
                     const SourcePatch& patch, PlacePoint* out);
/// Puts a point among those of a place; where it is full in place of the one that was seen least, if it was seen more often.
void add_point(const PlacePoint& point, KeptPlace* place);
/// Of a place that has points.
Scalar median_depth(const KeptPlace& place);

/// Copies the middle of a patch, and back. What comes back has no second level.
void crop_patch(const SourcePatch& from, PlacePatch* to);
void restore_patch(const PlacePatch& from, SourcePatch* to);

/// The view that the patch of a point is from.
CameraView first_view_of(const KeptPlace& place, const PlacePoint& point);

/// How far apart two views are, squared; 1 where they share about half of what they see:
///
///   D² = |p - p'|² / (kFarShift d)² + 2 (1 - z·z') / kFarTurn²          d: the smaller median depth, z: the directions of view
Scalar view_distance2(const Quat& q_a, const Vec3& p_a, Scalar depth_a, const Quat& q_b, const Vec3& p_b,
                      Scalar depth_b);

}  // namespace pf
