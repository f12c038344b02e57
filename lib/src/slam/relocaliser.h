#pragma once

#include <cstdint>

#include "base/arena.h"
#include "filter/filter.h"
#include "map/map.h"
#include "slam/frame.h"
#include "slam/image_front_end.h"
#include "slam/pixel_update.h"
#include "slam/pose_proposal.h"
#include "slam/settings.h"
#include "track/view_memory.h"

/// Finds the map again after frames that did not support the pose: nothing is taken in before two frames in a row agree with the map, and
/// with each other, far beyond chance.

namespace pf {

class Relocaliser {
 public:
  Relocaliser(const Settings& settings, Filter& filter, Map& map, Frame& frame, ImageFrontEnd& images,
              PixelUpdate& update)
      : settings_(settings), filter_(filter), map_(map), frame_(frame), images_(images), update_(update) {}

  bool layout(Arena& arena, int max_observations);
  void init();

  /// The picture of a usable frame.
  void look() { views_.look(images_.tracker().pyramid()); }
  /// Keeps what a tracked frame shows, and how far away that is.
  void remember_view(Scalar median_depth);
  /// Nothing is being searched for.
  void rest() { data_ = {Proposal(), false, data_.depth}; }
  /// Searches where the pose may be, and takes in what agrees when the frame before agreed as well. dt_ns: since that frame.
  void recover(std::int64_t dt_ns);

 private:
  /// What is kept between frames.
  struct Data {
    Proposal proposal;           ///< of the last frame
    bool agreed_nearby = false;  ///< in the last frame
    Scalar depth = 1;            ///< median, of the last frame that was tracked
  };

  bool is_narrow() const;
  void recover_nearby(int count);
  bool choose_search_pose(Body* pose, Mat6* P) const;
  int keep_placed(int count, const Mat6* P);
  int linearise_at(const Body& pose, int found);
  bool follows_last_proposal(const Body& pose, Scalar depth, std::int64_t dt_ns) const;
  bool is_spread(int found) const;
  Scalar median_depth(const Body& pose, int found) const;
  void mark_matches(int found);

  const Settings& settings_;
  Filter& filter_;
  Map& map_;
  Frame& frame_;
  ImageFrontEnd& images_;
  PixelUpdate& update_;
  ViewMemory views_;
  Data data_;
  Scalar* searched_px2_ = nullptr;  ///< max_observations each
  Vec3* place_ = nullptr;
  Vec2* pixel_ = nullptr;
};

}  // namespace pf
