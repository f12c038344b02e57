#pragma once

#include "frame/pose_hypotheses.h"
#include "keyframe_slam/memory/map_join.h"
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
    asked_ = AskedViews();
    joins_.init();
    clear_proposal();
  }

  /// Keeps the view of a tracked frame.
  void remember_view() { views_.keep_if_new(tracker_.pyramid(), motion_.body().q_WC, motion_.body().p_W); }
  /// After a tracked frame. Where it sees another part of the map than the last one that was asked about, the belief learns whether it
  /// looks like a part that is elsewhere.
  void note_view(Scalar median_depth);
  /// Where that view has shown the present map to be in an earlier one. Nothing is known of it afterwards.
  MapJoin take_join() { return joins_.take(); }
  /// Keeps the keyframes of a map that is left as places of the map with this id.
  void leave_map(std::uint32_t map_id);
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

  /// All of W is moved.
  void move(const Similarity& T);
  /// The window is moved by T, and kept views each by what is near: correction(q_WC, p_W).
  template <typename F>
  void move_each(const Similarity& T, F&& correction) {
    views_.move_each(correction);
    move_asked(T);
  }

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

  /// A view that note_view() asks about.
  struct Asked {
    CameraView view;
    Scalar depth = 0;           ///< median; 0: there is none
    bool is_described = false;  ///< its image is, and has not been compared with the map yet
  };
  struct AskedViews {
    Asked last;
    Asked judged;  ///< the last one that may look like another part of the map
  };

  void compare_view();
  void move_asked(const Similarity& T);
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
  AskedViews asked_;
  JoinFinder joins_{map_, recall_};
};

}  // namespace pf
