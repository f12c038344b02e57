#pragma once

#include "bundle/bundle.h"
#include "keyframe_slam/tracking/pose_measurement.h"

/// Follows the points of the first frame while no depths are known.

namespace pf {

class RotationTracking {
 public:
  RotationTracking(const Settings& settings, KeyframeMap& map, Frame& frame, KeyframeMotion& motion,
                   PointSearch& search, PoseMeasurement& pose)
      : settings_(settings), map_(map), frame_(frame), motion_(motion), search_(search), pose_(pose) {}

  bool layout(Arena& arena);

  /// Finds points about where they were last, as if the camera had only rotated. Updates the body with the pose fitted to them about the
  /// rotation that explains the image best, and accepts those that are within a few times the typical parallax of that rotation. base_W:
  /// place of the record's first frame; share: of the points that earlier frames found. False: too few.
  bool measure(const Vec3& base_W, const FindShare& share);

 private:
  int list();
  int search(int listed, bool follows);
  int search_again(bool follows);
  int find_points(const FindShare& share);
  int list_rays();
  void correct_body(int found, const Quat& q_WC, const Vec3& p_W);

  const Settings& settings_;
  KeyframeMap& map_;
  Frame& frame_;
  KeyframeMotion& motion_;
  PointSearch& search_;
  PoseMeasurement& pose_;
  BundlePixel* pixel_ = nullptr;  ///< one for each point
};

}  // namespace pf
