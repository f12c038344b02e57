#pragma once

#include "belief/pose_belief.h"
#include "bundle/zoom_fit.h"
#include "frame/frame.h"
#include "frame/settings.h"
#include "geometry/camera.h"
#include "geometry/pnp.h"
#include "track/view_memory.h"

/// Where a frame's pose is searched for, and whether a pose that is found is accepted. Both back ends search in the order of prior: about
/// the prediction, where the image as a whole has moved, about the last frame's proposal, about the kept view that is most like the image.
/// No update of the estimate comes before its evidence.

namespace pf {

class Archive;

/// A pose about which a frame is searched.
struct PoseHypothesis {
  Quat q_WC = Quat::Identity();
  Vec3 p_W = Vec3::Zero();
  Mat6 P = Mat6::Zero();  ///< covariance of (theta, p)

  /// Hypothesis with the same sigma about each axis: rotation [rad], position [m].
  static PoseHypothesis about(const Quat& q_WC, const Vec3& p_W, Scalar rotation, Scalar position);
  static PoseHypothesis of(const PoseEstimate& pose) { return {pose.q_WC, pose.p_WC, pose.covariance}; }
};

/// A pose that the matches of earlier frames propose and that is not accepted yet.
struct PoseProposal {
  bool is_set = false;
  Scalar log_odds = 0;  ///< that it is right
  Quat q_WC = Quat::Identity();
  Vec3 p_W = Vec3::Zero();
  Scalar depth = 1;  ///< median, of the measured points
};

/// Where the camera may be when it is not where it was predicted: at the last frame's proposal, else at the kept view that is most like the
/// image. depth: median, of the last measured points. False where there is neither.
bool find_elsewhere(const PoseProposal& last, const ViewMemory& views, const Pyramid& image, const Camera& lens,
                    Scalar depth, PoseHypothesis* out);

/// Adds the evidence of its pixels about the lens to a consensus; nothing where they do not measure it.
void note_zoom(const ZoomFit& fit, const Settings& settings, PoseConsensus* consensus);

/// Of the matches that agree with a pose (Match::agrees), how many have another one as their nearest neighbour among all that were searched
/// for in this frame, by their predicted pixels. Under the right pose any feature may be missed; in a wrong place the part that looks like
/// the right one is found whole.
int paired_inliers(const Frame& frame);
/// Counts them for a consensus that finds fewer features than earlier frames: it may be a part that looks like another one.
void note_paired(const Frame& frame, const FindShare& share, PoseConsensus* consensus);

/// The hypotheses of a frame that have been tried. n of them divide the odds of each by n.
class PoseHypotheses {
 public:
  PoseHypotheses(const Settings& settings, PoseBelief& belief) : settings_(settings), belief_(belief) {}

  /// Begins a frame with its first hypothesis.
  void begin() { tried_ = 1; }
  /// Adds a hypothesis about which the frame is searched.
  void add() { ++tried_; }

  /// Evidence for the present hypothesis.
  Scalar evidence(const PoseConsensus& consensus) const;
  /// Log-odds of its pose with that evidence, from those of the prediction.
  Scalar weigh(const PoseConsensus& consensus) const {
    return PoseBelief::updated(belief_.predicted(), evidence(consensus));
  }
  /// Whether a pose of these log-odds may update the estimate: it has enough inliers, and its log-odds reach kTracked. is_last: all
  /// features of the frame have been searched for; otherwise no evidence of the remaining ones may take the log-odds below that bound.
  bool accepts(const PoseConsensus& consensus, Scalar log_odds, bool is_last = true);

  void carry(Archive& archive);  ///< base/archive.h

 private:
  const Settings& settings_;
  PoseBelief& belief_;
  int tried_ = 1;
};

}  // namespace pf
