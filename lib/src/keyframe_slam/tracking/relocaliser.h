#pragma once

#include "frame/pose_hypotheses.h"
#include "keyframe_slam/memory/keyframe_recall.h"
#include "keyframe_slam/memory/place_keeper.h"
#include "keyframe_slam/tracking/keyframe_tracking.h"

/// Finds the window's map again after frames that did not support the pose (lib/docs/theory/states.md).

namespace pf {

class Archive;

class KeyframeRelocaliser {
 public:
  KeyframeRelocaliser(const Settings& settings, KeyframeMap& map, KeyframeMotion& motion, const Tracker& tracker,
                      KeyframeTracking& measuring, PoseBelief& belief)
      : settings_(settings),
        map_(map),
        motion_(motion),
        tracker_(tracker),
        measuring_(measuring),
        belief_(belief),
        keeper_(settings, map) {}

  bool layout(Arena& arena) {
    keeper_.layout(arena);
    recall_.layout(arena);
    return views_.layout(arena, settings_.kept.views);
  }
  void init() {
    views_.init();
    recall_.init();
    asked_ = Asked();
    clear_proposal();
  }

  /// Keeps the view of a tracked frame.
  void remember_view() { views_.keep_if_new(tracker_.pyramid(), motion_.body().q_WC, motion_.body().p_W); }
  /// After a tracked frame. Where it sees another part of the map than the last one that was asked about, the belief learns whether it
  /// looks like a part that is elsewhere.
  void note_view(Scalar median_depth);
  /// Drops the proposals of earlier frames, since the map is tracked.
  void clear_proposal() {
    proposal_ = rival_ = PoseProposal();
    recalled_ = 0;
  }
  /// True where the prediction is certain enough to search about it.
  bool is_prediction_narrow(Scalar median_depth) const;
  /// Searches for the pose where it is not the predicted one: about the last frame's proposal, a place that is recognised in this image, or
  /// a similar kept view. A place is searched for together with its rival, the place with most evidence for another pose.
  void recover(Scalar median_depth);
  /// The place by which the map was found again in this frame; null: none.
  const Mat6* found_covariance() const;

  int kept_views() const { return views_.count(); }
  PlaceKeeper& keeper() { return keeper_; }

  void carry(Archive& archive);  ///< base/archive.h

 private:
  /// Result of a search about one hypothesis.
  struct Tried {
    bool found = false;
    CameraPose pose;
    Mat6 information = Mat6::Zero();
    PoseConsensus consensus;
    Scalar log_odds = 0;

    PoseProposal proposal(Scalar depth) const {
      return found ? PoseProposal{true, log_odds, pose.q_WC, pose.p_WC, depth} : PoseProposal();
    }
  };

  /// The last view that note_view() asked about.
  struct Asked {
    CameraView view;
    Scalar depth = 0;           ///< median; 0: there is none
    bool is_described = false;  ///< its image is, and has not been compared with the map yet
  };

  bool recall(PoseHypothesis* place, PoseHypothesis* rival, bool* has_rival);
  Tried try_pose(const PoseHypothesis& about, const PoseProposal& before, Scalar median_depth);

  const Settings& settings_;
  KeyframeMap& map_;
  KeyframeMotion& motion_;
  const Tracker& tracker_;
  KeyframeTracking& measuring_;
  PoseBelief& belief_;
  ViewMemory views_;
  PlaceKeeper keeper_;
  KeyframeRecall recall_{settings_, map_};
  PoseProposal proposal_, rival_;  ///< of earlier frames
  std::uint32_t recalled_ = 0;     ///< place that the proposal comes from; 0: none
  bool recalled_in_vain_ = false;  ///< the last frame's place was not confirmed
  Asked asked_;
};

}  // namespace pf
