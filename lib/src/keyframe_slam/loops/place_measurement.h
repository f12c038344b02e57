#pragma once

#include "belief/pose_belief.h"
#include "frame/image_search.h"
#include "frame/noise_model.h"
#include "keyframe_slam/map/keyframe_map.h"
#include "keyframe_slam/tracking/pose.h"

/// Pose of an image against places: their points are searched for by their patches about a pose, though they are no points of the window.

namespace pf {

class Archive;

/// What the search for the points of some places has found.
struct PlaceSighting {
  int inliers = 0;  ///< 0: no pose
  CameraPose pose;
  Mat6 information = Mat6::Zero();  ///< of the matches alone
  PoseConsensus consensus;
};

/// Derivative of the pixel of a place's point by its position in the camera K of the place:   z = pi(p_W), p_W = p_K + R_WK x_K
///
/// J_pose   2x6 of project_from_pose() by (theta, p) of the camera: a point moves in it as the camera moves the other way
inline Mat23 pixel_by_place_point(const Quat& q_WK, const Mat26& J_pose) {
  return -J_pose.rightCols<3>().lazyProduct(q_WK.toRotationMatrix());
}

class PlaceMeasurement {
 public:
  static constexpr int kMaxPlaces = 6;

  PlaceMeasurement(const Settings& settings, const KeyframeMap& map, const NoiseModel& noise, const ImageSearch& images)
      : settings_(settings), map_(map), noise_(noise), images_(images) {}

  bool layout(Arena& arena);
  void init() { pose_.init(); }

  /// Searches for the points of up to kMaxPlaces places, but for those that the newest keyframe sees as points of the window. about: where
  /// the camera is against the places, with covariance.
  PlaceSighting measure(const int* places, int count, const PosePrior& about, const PoseBelief& belief);

  void carry(Archive& archive) { pose_.carry(archive); }  ///< base/archive.h

 private:
  static constexpr int kCapacity = kMaxPlaces * KeptPlace::kMaxPoints;

  struct Searched {
    const KeptPlace* place;
    const PlacePoint* point;
    Vec3 p_W;
    Vec2 predicted, measured;
    Mat2 innovation;
    Mat2 noise;   ///< of the match
    Scalar area;  ///< searched [px^2]
  };

  int list(const int* places, int count, const PosePrior& about);
  bool is_listed(int count, std::uint32_t id) const;
  bool is_seen(std::uint32_t id) const;
  Mat2 spread_of(const Searched& s, const Mat26& J_pose) const;
  bool expect(const PosePrior& about, Searched* s) const;
  bool find(const PosePrior& about, Searched* s, int* searched) const;
  int search(int found, int first, int end, const PosePrior& about, int* searched);
  void fit(int found, int searched, const PosePrior& about, PlaceSighting* out);

  const Settings& settings_;
  const KeyframeMap& map_;
  const NoiseModel& noise_;
  const ImageSearch& images_;
  Searched* point_ = nullptr;
  KeyframePose pose_;
};

}  // namespace pf
