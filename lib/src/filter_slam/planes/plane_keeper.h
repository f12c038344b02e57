#pragma once

#include <cstdint>

#include "base/status.h"
#include "filter/filter.h"
#include "filter/vertical.h"
#include "filter_slam/features/feature_keeper.h"
#include "filter_slam/planes/plane_own_places.h"
#include "frame/frame.h"
#include "frame/settings.h"
#include "map/map.h"
#include "map/plane_majority.h"
#include "map/plane_search.h"

/// Keeps the planes of the map: unfolds outliers, folds and fixes points; discovers, merges and dissolves planes. Gee 2007, section 3
/// (lib/docs/planes.md).

namespace pf {

/// How many features hang on a plane.
struct PlanePoints {
  int folded = 0;  ///< fixed ones among them
  int fixed = 0;
  int on_trial = 0;  ///< of the folded ones, those that began on the plane and have not been believed yet
};

/// Outline of a plane (entry of the table) in the coordinates of its frame: the part that was seen before, extended by the points that
/// are on it now, without isolated ones. outline may be null.
PlanePoints outline_plane(const Filter& filter, const Map& map, int plane_entry, PlaneOutline* outline);

class PlaneKeeper {
 public:
  PlaneKeeper(const Settings& settings, Filter& filter, Map& map, Frame& frame, FeatureKeeper& features)
      : settings_(settings),
        filter_(filter),
        map_(map),
        frame_(frame),
        features_(features),
        places_(filter, map, frame) {}

  bool layout(Arena& arena, int max_features);
  void init() {
    data_ = Data();
    places_.init();
    for (int i = 0; told_ != nullptr && i < map_.planes.capacity(); ++i) told_[i] = Told();
  }

  /// Adds a wall; so many rows stay free beside it. Rows are made free by evicting features that were not seen since not_since_ns, where
  /// features may go. kFull: no room for it; nothing has changed then.
  Status add_wall(const PlanePrior& prior, int reserved_rows, bool may_evict, std::int64_t not_since_ns,
                  std::uint32_t* id);

  /// A plane of the table is vertical within sigma [rad], which counts once; 0 forgets it. The state has gravity. kRange: what is known
  /// of both contradicts it; nothing has changed then.
  Status set_vertical(int plane_entry, Scalar sigma);

  /// The work of one frame. Folds, fixes and merges one plane per frame, in turn, so that the work is bounded. may_doubt: the map's
  /// depths are sure enough to doubt a wall by.
  void maintain(bool may_doubt = true);
  /// Walls are compared with the map for the first time: planes that were found in a map of another size end, since their points would
  /// not fold into walls, and those before a wall fold into it.
  void meet_walls();

 private:
  enum class TrialVerdict { kOpen, kThere, kElsewhere };

  /// What is kept between frames.
  struct Data {
    std::uint32_t random = 1;    ///< of what is drawn before walls
    std::uint32_t searches = 0;  ///< for new planes, so far
    bool met_late = false;       ///< walls came into view in a map of unknown size
  };
  /// That a plane is vertical.
  struct Told {
    std::uint32_t id = 0, generation = 0;  ///< of the plane, and of the filter then
    VerticalRow row;
  };

  // plane_keeper.cpp: points of planes
  void judge_trials();
  TrialVerdict judge_depth(int entry) const;
  void unfold_outliers();
  void inflate(int plane_slot, int children);
  Vec3 doubt() const;
  bool is_in_reach(int plane_entry, const Vec3& p_W) const;
  bool lies_on(int plane, int slot) const;
  void fold_into(int plane_entry);
  void support(int plane_entry, int slot);
  void fix_on(int plane_entry);
  bool is_converged(int entry) const;
  bool is_settled(int entry) const;
  bool is_certain(int entry, Mat3* covariance) const;

  // plane_lifecycle.cpp: whole planes
  int list_candidates();
  void discover();
  bool same_plane(int slot, int other) const;
  void merge_into(int plane_entry);
  bool give_points(int from_entry, int to_entry);
  void settle_frame(int plane_entry);
  void dissolve(int plane_entry);
  void dissolve_weak();

  // plane_places.cpp: points that lie elsewhere
  int list_places(int plane, const Vec3& n_W, JudgedPoint* points, int* slots) const;
  void judge_places(int plane_entry);
  void leave(int plane_entry, int slot, const Vec3& p_W, const Vec3& n_W);
  void turn(int plane_entry, const MajorityPlane& to);

  // plane_walls.cpp: planes known beforehand
  FoldRule fold_rule(int plane_entry) const;
  bool is_before_wall(int plane_entry, const Vec3& p_W) const;
  int list_before_wall(int plane_entry, int* slots, int capacity);
  bool may_set_scale(int plane_entry) const;
  bool knows_scale() const;
  bool is_on_found_plane(int entry) const;
  unsigned find_wall_consensus(int plane_entry, const int* slots, int count, int* size);
  void fold_by_consensus(int plane_entry);
  void judge_wall(int plane_entry);
  void doubt_wall(int plane_entry);

  // plane_vertical.cpp: planes that somebody says are vertical
  VerticalRow* told_row(int plane_entry);

  const Settings& settings_;
  Filter& filter_;
  Map& map_;
  Frame& frame_;
  FeatureKeeper& features_;
  OwnPlaces places_;
  Data data_;
  Told* told_ = nullptr;                 ///< of each entry; null where gravity is not estimated
  PlaneCandidate* candidate_ = nullptr;  ///< max_features; their names are entries of the feature table
  ScaleRow scale_;                       ///< scratch: picks the log scale out of an error
};

}  // namespace pf
