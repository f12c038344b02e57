#pragma once

#include <cstdint>

#include "base/arena.h"
#include "filter/filter.h"
#include "filter_slam/features/image_front_end.h"
#include "filter_slam/pose/pixel_update.h"
#include "frame/frame.h"
#include "frame/settings.h"
#include "map/map.h"
#include "track/view_memory.h"

/// Finds the map again where the prediction is too vague to search about it. Updates the filter once the evidence of frames is enough to
/// accept a pose (lib/docs/theory/belief.md).

namespace pf {

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

  bool layout(Arena& arena, int max_observations, int max_kept_views);
  void init();

  /// Keeps the view of a tracked frame, with the median depth of its features.
  void remember_view(Scalar median_depth);
  /// True where the prediction is certain enough for a linear consensus about it.
  bool is_prediction_narrow() const;
  /// Searches where the pose may be if the prediction is wrong. before: outcome of the frame's earlier updates. Returns the outcome of all.
  UpdateOutcome recover(const MeasureMode& mode, const UpdateOutcome& before);

  int kept_views() const { return views_.count(); }

 private:
  /// Where to search, instead of about the prediction.
  struct SearchPose {
    bool given = false;
    Body body;
    Mat6 P = Mat6::Zero();  ///< of (theta, p)
  };

  SearchPose choose_search_pose() const;
  UpdateOutcome measure_about(const SearchPose& about, int found, const UpdateMode& mode, const UpdateOutcome& before);
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
  Scalar depth_ = 1;                ///< median, of the last tracked frame
  Scalar* searched_px2_ = nullptr;  ///< max_observations each
  Vec3* point_W_ = nullptr;
  Vec2* pixel_ = nullptr;
};

}  // namespace pf
