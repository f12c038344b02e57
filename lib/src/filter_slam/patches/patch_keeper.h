#pragma once

#include <cstdint>

#include "filter/filter.h"
#include "filter_slam/features/feature_keeper.h"
#include "frame/frame.h"
#include "frame/noise_model.h"
#include "frame/settings.h"
#include "frame/tracking_state.h"
#include "map/map.h"
#include "track/align_plane.h"
#include "track/patch_search.h"
#include "track/patch_store.h"

/// Keeps the patches of walls: finds them in the image, tells which plane each lies on and updates the filter with it, begins new ones, and
/// drops those that fail.
/// Servant 2008, sections 2.3 and 2.4 (lib/docs/homography.md).

namespace pf {

class PatchKeeper {
 public:
  static constexpr int kMaxPatches = 32;  ///< capacity.max_patches at most
  static constexpr int kWorth = 8;        ///< inliers that a patch counts as

  PatchKeeper(const Settings& settings, Filter& filter, Map& map, Frame& frame, FeatureKeeper& features,
              TrackingState& tracking)
      : settings_(settings), filter_(filter), map_(map), frame_(frame), features_(features), tracking_(tracking) {}

  bool layout(Arena& arena);
  void init();

  /// Finds the patches in the image, and updates the filter with each that passes its gate. is_young: the map's depths are not sure yet,
  /// and a patch without parallax waits twice as long.
  void measure(const Pyramid& image, bool is_young);
  /// Drops patches that fail; supported: the frame's measurements support its pose. Begins new ones where it may.
  void maintain(const Pyramid& image, bool supported, bool may_begin);

  const PatchStore& patches() const { return store_; }
  /// Depths of the inliers' middles. Returns how many.
  int inlier_depths(Scalar* depth) const;

 private:
  using Mat8 = PatchMeasurement::Matrix;
  using Vec8 = PatchMeasurement::Vector;

  /// A patch as the filter expects it.
  struct Sight {
    Mat3 H_CK;       ///< rays of the reference at depth 1 to rays of this image
    Vec2 corner[4];  ///< [px]
    Scalar cosine;   ///< between the view of its middle and the wall's normal
    Vec3 middle_W;
  };

  // patch_keeper.cpp
  void follow_filter();
  int list_in_order(int* order) const;
  int wall_of(const StoredPatch& patch) const;
  void measure_patch(const Pyramid& image, int i);
  bool align(const Pyramid& image, const Sight& sight, StoredPatch* patch, PlaneAlignment* found);
  bool find_from_afar(const Pyramid& image, const StoredPatch& patch, Sight* sight);
  bool begin_block(StoredPatch* patch, const Mat8& covariance);
  void put_measured(const StoredPatch& patch);
  Scalar misfit(const StoredPatch& patch, int plane, Body* near);
  Scalar bend_of(const StoredPatch& patch) const;
  bool take_bent(const StoredPatch& patch, int plane);
  void update(StoredPatch* patch, int wall);
  Mat8 noise_of(const StoredPatch& patch) const;
  void learn_noise();
  void drop(int i);
  void keep_plane(int entry);
  void drop_failing(bool supported);

  // patch_consensus.cpp
  /// Patches that were found before any was taken in.
  struct Witnesses {
    static constexpr int kMax = 8;
    int count = 0;
    int entry[kMax];
    Body near[kMax];  ///< the pose that the prior and this patch's corners make most likely
  };
  Witnesses find_witnesses(const Pyramid& image, const int* order, int count);
  bool agree(const StoredPatch& a, const StoredPatch& b, const Body& near);
  void put_agreeing_first(const Pyramid& image, int* order, int count);

  // patch_waiting.cpp
  bool follow_waiting(const Pyramid& image, bool supported, Sight* sight, StoredPatch* patch, PlaneAlignment* found);
  void measure_waiting(const Pyramid& image, bool is_young, StoredPatch* patch);
  bool expect_waiting(const StoredPatch& patch, Sight* sight) const;
  bool may_lie_on(const StoredPatch& patch, int entry, Scalar* range) const;
  int try_planes(StoredPatch* patch, bool counts);
  bool explains(const StoredPatch& patch, int entry);
  Scalar parallax_of(const StoredPatch& patch) const;
  bool has_parallax(const StoredPatch& patch, Scalar min_px) const;
  bool is_told_by_plan_alone(int entry) const;
  bool is_off_most(const StoredPatch& patch, int entry) const;
  bool wall_to_patch(const StoredPatch& patch, const Vec3& m, int entry, Scalar* ratio) const;
  bool is_before_another(const StoredPatch& patch, int entry) const;
  bool is_seen_through(const StoredPatch& patch, int entry) const;
  void join(StoredPatch* patch, int entry);
  void refuse(StoredPatch* patch);
  void give_up(StoredPatch* patch);

  // patch_founding.cpp
  bool fit_plane_to(const StoredPatch& patch, PlaneFit* fit, Scalar* range, Vec3* m) const;
  void note_plane(StoredPatch* patch) const;
  void found_or_wait(StoredPatch* patch);
  bool would_tell(const StoredPatch& patch, int plane, const Mat3& prior);
  bool found_plane(StoredPatch* patch);
  void extend_plane(const StoredPatch& patch, int entry);

  // patch_sight.cpp
  bool expect(const StoredPatch& patch, int wall, Sight* sight) const;
  bool is_in_view(const Sight& sight) const;
  int hiding_wall(int wall, const Sight& sight) const;
  bool is_looked_for(int hiding) const { return hiding < 0 || is_told_by_plan_alone(hiding); }
  bool move_to(const StoredPatch& patch, const Vec2& shift, Sight* sight) const;
  bool predict_near(const StoredPatch& patch, int plane, const Body& near, PatchMeasurement* z);
  bool linearise_near(const StoredPatch& patch, int plane, Body* near);
  void set_pose(const Body& pose);

  struct Square {
    int left, top, side;
    Scalar score;
  };

  // patch_obstacles.cpp
  struct Obstacles {
    static constexpr int kMax = 128;
    int count = 0;
    Vec2 pixel[kMax];

    /// Whether one is in the square, or just beside it.
    bool are_in(const Square& square) const;
  };
  struct Refusal {
    std::uint32_t plane = 0;  ///< id; 0: none
    int born = 0;             ///< frame in which the patch began
    Vec3 middle_W;
  };
  static constexpr int kMaxRefusals = 16;
  void list_obstacles(int wall, Obstacles* obstacles) const;
  bool is_before(const StoredPatch& patch, int wall) const;
  void note_refused(const StoredPatch& patch, int wall);
  void keep_refusal(const Refusal& refusal);
  bool is_told_already(std::uint32_t plane, int born) const;
  void count_through(StoredPatch* patch, int hiding, const Vec3& middle_W);

  // patch_selection.cpp
  static constexpr int kMaxSquares = 6;
  static constexpr int kMaxWalls = 64;  ///< capacity.max_planes at most
  void begin_patches(const Pyramid& image);
  int wanted_on(int wall, int* youngest) const;
  int list_squares(const Pyramid& image, int wall, int side, const Obstacles& obstacles, Square* square) const;
  bool is_on_wall(int wall, const Square& square, Scalar* cosine) const;
  bool is_free(const Square& square) const;
  void begin_beside_walls(const Pyramid& image, int* camera);
  bool begin_at(const ImageView& image, int wall, const Square& square, int* camera);
  bool make_room(int rows, bool for_camera);
  bool drop_oldest_camera();

  const Settings& settings_;
  Filter& filter_;
  Map& map_;
  Frame& frame_;
  FeatureKeeper& features_;
  TrackingState& tracking_;
  PatchStore store_;
  NoiseModel noise_;                         ///< of corners, pooled over all patches
  ResidualTrace residuals_[kMaxPatches][4];  ///< of each entry's corners
  PatchSearch search_;
  PlaneAligner aligner_;
  PatchMeasurement z_;               ///< scratch: the patch that is measured
  PatchMeasurement of_another_;      ///< scratch: one that it is compared with
  bool is_found_[kMaxPatches] = {};  ///< each entry has corners of this frame already
  bool is_contested_ = false;        ///< nothing supports the pose of this frame but patches of which no two agree
  std::uint32_t generation_ = 0;     ///< of the filter that the patches have blocks in
  Refusal refusals_[kMaxRefusals];   ///< the last ones
  int next_refusal_ = 0;
  Quat q_last_ = Quat::Identity();  ///< q_WC of the last frame, where the corners were
  int in_vain_[kMaxWalls] = {};     ///< frame in which each plane's wall had no place for a patch that it wants
  int in_vain_beside_ = 0;          ///< likewise what no wall covers
};

}  // namespace pf
