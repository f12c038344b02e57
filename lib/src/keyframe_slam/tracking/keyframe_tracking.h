#pragma once

#include "frame/pose_hypotheses.h"
#include "keyframe_slam/tracking/motion.h"
#include "keyframe_slam/tracking/point_search.h"
#include "keyframe_slam/tracking/pose_measurement.h"

/// Measures an image with the window's map: searches for points about a pose, fits the pose, and updates the body.

namespace pf {

class Archive;

class KeyframeTracking {
 public:
  KeyframeTracking(const Settings& settings, KeyframeMap& map, Frame& frame, KeyframeMotion& motion, NoiseModel& noise,
                   PointSearch& search, PoseMeasurement& pose, PoseBelief& belief)
      : settings_(settings),
        map_(map),
        frame_(frame),
        motion_(motion),
        noise_(noise),
        search_(search),
        pose_(pose),
        belief_(belief),
        hypotheses_(settings, belief) {}

  /// Finds points with a depth about the predicted pose, and updates the body with the pose fitted to them; then finds those without a
  /// depth. Where those with a depth give no pose, it is fitted to all. While another prediction can be tried it is fitted to none, nor
  /// used where it contradicts the first one, or where fewer points than usual have it and the first one had more evidence: points without
  /// a depth follow any translation, and are no evidence between predictions.
  void measure(Scalar median_depth);
  /// While few points have a depth: finds all points about the predicted pose, and updates the body with the pose fitted to all. A point
  /// without a depth constrains the pose but for a translation along its epipolar line.
  void measure_young(Scalar median_depth);
  /// Finds points with a depth about another pose than the predicted one. Changes nothing but the frame's matches. Returns the number of
  /// inliers, the pose with its information, and the consensus, for its evidence.
  int measure_about(const PosePrior& about, CameraPose* pose, Mat6* information, PoseConsensus* consensus);
  /// Removes the matches of the last measure_about(), before the frame is searched about another pose.
  void forget_searches() { frame_.forget_searches(); }
  /// Updates the body with a pose that measure_about() returned, and accepts the matches that agree with it. False where fewer do than a
  /// tracked frame needs: the body is as before.
  bool correct(const CameraPose& pose, const Mat6& information);
  /// Updates the noise model with the residuals of this frame's inliers.
  void learn_noise();

  void carry(Archive& archive);  ///< base/archive.h

 private:
  int search_by_scouts(const PosePrior& about, CameraPose* pose, Mat6* information, PosePrior* moving);
  bool look_again(const PosePrior& about, CameraPose* pose, Mat6* information, PosePrior* moving);
  bool narrow(const PosePrior& about, const CameraPose& pose, const Mat6& information, KeyframeMotion* after,
              PosePrior* out) const;
  bool correct_by_rows(const PosePrior& before, CameraPose pose, Mat6 information);
  bool apply(const CameraPose& pose, const Mat6& information, PosePrior* now);
  int mark(const PosePrior& at);
  void accept_marked();
  void accept(const Vec2& pixel, Match* match);
  bool measure_placed(const PosePrior& prior, CameraPose* pose, Mat6* information);
  bool contradicts(const CameraPose& pose, const Mat6& information) const;
  void measure_all(const PosePrior& prior, Scalar median_depth);
  void fit_all(int found, const PosePrior& prior, Scalar median_depth);
  bool is_believed(const PoseConsensus& consensus);
  void measure_unplaced(Scalar depth);

  const Settings& settings_;
  KeyframeMap& map_;
  Frame& frame_;
  KeyframeMotion& motion_;
  NoiseModel& noise_;
  PointSearch& search_;
  PoseMeasurement& pose_;
  PoseBelief& belief_;
  PoseHypotheses hypotheses_;
  /// What the first prediction of a frame has found.
  struct First {
    std::int64_t t_ns = INT64_MIN;
    Scalar evidence = 0;
  };
  First first_;
  int found_ = 0;  ///< points with a depth, by the last measure_about(), at the front of the search's list
};

}  // namespace pf
