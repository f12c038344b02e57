#pragma once

#include <cstdint>

#include "base/arena.h"
#include "filter/filter.h"
#include "filter_slam/features/feature_search.h"
#include "filter_slam/pose/pixel_update.h"
#include "filter_slam/pose/triple_consensus.h"
#include "frame/frame.h"
#include "frame/settings.h"
#include "map/map.h"
#include "track/view_memory.h"

/// Finds the map again after frames that did not support the pose. Updates the filter only after frames in a row were consistent with the
/// map, and with each other, far beyond chance. See lib/docs/states.md.

namespace pf {

class Relocaliser {
 public:
  Relocaliser(const Settings& settings, Filter& filter, Map& map, Frame& frame, FeatureSearch& search,
              PixelUpdate& update)
      : settings_(settings), filter_(filter), map_(map), frame_(frame), search_(search), update_(update) {}

  bool layout(Arena& arena, int max_observations, int max_kept_views);
  void init();

  /// Keeps the view of a tracked frame, and how far away its features are.
  void remember_view(Scalar median_depth);
  /// Searches where the pose may be.
  void recover();

  int kept_views() const { return views_.count(); }

 private:
  /// Where to search, instead of about the prediction.
  struct SearchPose {
    bool given = false;
    Body body;
    Mat6 P = Mat6::Zero();  ///< of (theta, p)
  };

  bool is_prediction_narrow() const;
  SearchPose choose_search_pose() const;
  void recover_nearby(int found);
  void recover_anywhere(const SearchPose& about, int found);
  void set_pose(const Body& pose);
  int keep_placed(const SearchPose& about, int count);
  int linearise_at(const Body& pose, int found);
  bool is_beyond_chance(const TripleConsensus& consensus, int found) const;
  bool is_spread(int found) const;
  Scalar median_depth(const Body& pose, int found) const;
  void mark_matches(int found);
  void hold_back(int found);

  const Settings& settings_;
  Filter& filter_;
  Map& map_;
  Frame& frame_;
  FeatureSearch& search_;
  PixelUpdate& update_;
  ViewMemory views_;
  Scalar depth_ = 1;                ///< median, of the last tracked frame
  Scalar* searched_px2_ = nullptr;  ///< max_observations each
  Vec3* point_W_ = nullptr;
  Vec2* pixel_ = nullptr;
};

}  // namespace pf
