#pragma once

#include "belief/pose_evidence.h"
#include "keyframe_slam/tracking/point_search.h"
#include "keyframe_slam/tracking/pose.h"

/// Pose of a frame from the points that were found, and its evidence.

namespace pf {

class Archive;

/// All functions work on the first `found` points of the search's list, which were found.
class PoseMeasurement {
 public:
  PoseMeasurement(const Settings& settings, const KeyframeMap& map, Frame& frame, const NoiseModel& noise,
                  const PointSearch& search)
      : settings_(settings), map_(map), frame_(frame), noise_(noise), search_(search) {}

  bool layout(Arena& arena) { return pose_.layout(arena, settings_.max_features); }
  void init() { pose_.init(); }

  /// Pose that most of the points support, all of which have a depth. Returns the number of inliers, 0 where they are too few.
  int find(int found, const PosePrior& prior, CameraPose* pose, Mat6* information);
  /// Pose fitted to all points, those without a depth as well. Pixels are taken to the frame's time by how far they have moved. depth: of
  /// points without one. shared: how many these are; their depths may be wrong together, so that their mean is known no better than one of
  /// them. 0: their median is the unit of length, and each is wrong by itself. Returns the number of inliers.
  int fit(int found, const PosePrior& prior, Scalar depth, int shared, CameraPose* pose, Mat6* information);
  /// Consensus of this frame's searches for the pose of the last find() or fit(), about the same prior. Notes which matches agree with it.
  PoseConsensus consensus(int inliers, int found, const PosePrior& prior, const CameraPose& pose,
                          const Mat6& information) const;

  /// Adds what the inliers of that pose contribute to the belief in the lens; before the pose is used.
  void weigh_lens(int found, const CameraPose& pose, PoseConsensus* consensus) const;

  bool is_inlier(int c) const { return pose_.is_inlier(c); }
  const unsigned char* inliers() const { return pose_.inliers(); }
  /// Bound within which a match supports a pose [px].
  Scalar bound_px() const;

  void carry(Archive& archive);  ///< base/archive.h

 private:
  void make_match(int c, const PosePrior& prior, Scalar depth, int shared);
  Mat2 noise_of(int c, const PosePrior& prior, Scalar depth, int shared) const;

  const Settings& settings_;
  const KeyframeMap& map_;
  Frame& frame_;
  const NoiseModel& noise_;
  const PointSearch& search_;
  KeyframePose pose_;
};

}  // namespace pf
