#pragma once

#include <cstdint>

#include "base/arena.h"
#include "filter/filter.h"
#include "filter_slam/features/image_front_end.h"
#include "filter_slam/memory/filter_memory.h"
#include "filter_slam/pose/pixel_update.h"
#include "frame/frame.h"
#include "frame/settings.h"
#include "map/map.h"
#include "track/view_memory.h"

/// Finds the map again where the prediction is too vague to search about it. Updates the filter once the evidence of frames is enough to
/// accept a pose (lib/docs/theory/belief.md).

namespace pf {

class Archive;

class Relocaliser {
 public:
  Relocaliser(const Settings& settings, Filter& filter, Map& map, Frame& frame, FeatureSearch& search,
              PixelUpdate& update, PoseBelief& belief)
      : settings_(settings),
        filter_(filter),
        map_(map),
        frame_(frame),
        search_(search),
        update_(update),
        belief_(belief) {}

  /// memory: may be null.
  bool layout(Arena& arena, int max_observations, int max_kept_views, FilterMemory* memory);
  void init();
  /// Begins a frame, dt_ns after the one before.
  void begin_frame(std::int64_t dt_ns) {
    update_.proposals().begin_frame(dt_ns);
    if (memory_ != nullptr) memory_->rivals().begin_frame(dt_ns);
  }

  /// Keeps the view of a tracked frame, with the median depth of its features.
  void remember_view(Scalar median_depth);
  /// True where the prediction is certain enough for a linear consensus about it.
  bool is_prediction_narrow() const;
  /// Searches where the pose may be if the prediction is wrong. before: outcome of the frame's earlier updates. Returns the outcome of all.
  UpdateOutcome recover(const MeasureMode& mode, const UpdateOutcome& before);

  int kept_views() const { return views_.count(); }

  void carry(Archive& archive);  ///< base/archive.h

 private:
  /// Where to search, instead of about the prediction.
  struct SearchPose {
    bool given = false;
    Body body;
    Mat6 P = Mat6::Zero();  ///< of (theta, p)

    void set(const PoseHypothesis& pose) {
      given = true;
      body.q_WC = pose.q_WC;
      body.p_W = pose.p_W;
      P = pose.P;
    }
  };
  /// What a search about a pose has found.
  struct Tried {
    int found = 0;  ///< matches
    Body pose;      ///< that they propose
    PoseConsensus consensus;
  };

  SearchPose choose_search_pose(SearchPose* rival);
  int search_about(const SearchPose& about, bool parallax_lasts);
  bool try_pose(const SearchPose& about, int found, Tried* out);
  Scalar odds_against(const SearchPose& rival, bool parallax_lasts);
  UpdateOutcome measure_about(const SearchPose& about, int found, Scalar against, const UpdateMode& mode,
                              const UpdateOutcome& before);
  void set_pose(const Body& pose);
  int keep_placed(const SearchPose& about, int count);
  int linearise_at(const Body& pose, int found);
  Scalar median_depth(const Body& pose, int found) const;
  void mark_matches(int found);
  void hold_back(int found);

  const Settings& settings_;
  Filter& filter_;
  Map& map_;
  Frame& frame_;
  FeatureSearch& search_;
  PixelUpdate& update_;
  PoseBelief& belief_;
  ViewMemory views_;
  PartPointer<FilterMemory, kHasMemory> memory_;
  Scalar depth_ = 1;                ///< median, of the last tracked frame
  Scalar* searched_px2_ = nullptr;  ///< max_observations each
  Vec3* point_W_ = nullptr;
  Vec2* pixel_ = nullptr;
};

}  // namespace pf
