#pragma once

#include "belief/pose_belief.h"
#include "bundle/zoom_fit.h"
#include "frame/settings.h"
#include "geometry/camera.h"
#include "track/view_memory.h"

/// Where a frame's pose is looked for, and whether what is found there is believed. Both back ends search in the order of prior: about the
/// prediction, about where the picture as a whole has gone, about the last frame's proposal, about a kept view that looks like the image.
/// Nothing moves the estimate before its evidence has been weighed.

namespace pf {

/// A pose about which a frame is searched.
struct PoseHypothesis {
  Quat q_WC = Quat::Identity();
  Vec3 p_W = Vec3::Zero();
  Mat6 P = Mat6::Zero();  ///< covariance of (theta, p)

  /// Known to so much in any direction.
  static PoseHypothesis about(const Quat& q_WC, const Vec3& p_W, Scalar rotation, Scalar position);
};

/// A pose that the matches of earlier frames have proposed, before any of it is believed.
struct PoseProposal {
  bool is_set = false;
  Scalar log_odds = 0;  ///< that it is right
  Quat q_WC = Quat::Identity();
  Vec3 p_W = Vec3::Zero();
  Scalar depth = 1;  ///< of what is seen, median
};

/// Where the camera may be when it is not where it was predicted: where the last frame proposes, else where a kept view was that looks most
/// like the image. depth: median, of what was seen last. False where neither says anything.
bool find_elsewhere(const PoseProposal& last, const ViewMemory& views, const Pyramid& image, const Camera& lens,
                    Scalar depth, PoseHypothesis* out);

/// Adds to a consensus what its pixels say of the lens. Nothing where they do not say.
void note_zoom(const ZoomFit& fit, const Settings& settings, PoseConsensus* consensus);

/// Those of a frame that have been tried: several halve, third, ... the odds of each.
class PoseHypotheses {
 public:
  PoseHypotheses(const Settings& settings, PoseBelief& belief) : settings_(settings), belief_(belief) {}

  /// A frame begins with its first hypothesis.
  void begin() { tried_ = 1; }
  /// The frame is searched about another one.
  void add() { ++tried_; }

  /// Evidence for the present one.
  Scalar evidence(const PoseConsensus& consensus) const;
  /// Log-odds of its pose with that, before which it had those of the prediction.
  Scalar weigh(const PoseConsensus& consensus) const {
    return PoseBelief::updated(belief_.predicted(), evidence(consensus));
  }
  /// Whether a pose of these log-odds may move the estimate: it is believed, by enough inliers. is_last: all of the frame has been searched
  /// for. Else nothing that the rest of it can say may take that belief away again.
  bool accepts(const PoseConsensus& consensus, Scalar log_odds, bool is_last = true);

 private:
  const Settings& settings_;
  PoseBelief& belief_;
  int tried_ = 1;
};

}  // namespace pf
