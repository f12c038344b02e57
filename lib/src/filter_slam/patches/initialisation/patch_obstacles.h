#pragma once

#include "filter/filter.h"
#include "filter_slam/patches/patch_refusals.h"
#include "frame/frame.h"
#include "map/map.h"

/// Squares of the image where patches may begin, and obstacles before their wall.

namespace pf {

struct PatchSquare {
  int left, top, side;  ///< [px]
  Scalar score;

  /// From the middle to the middles of the pixels at its edge.
  Scalar half() const { return static_cast<Scalar>(side - 1) / 2; }
  Vec2 middle() const { return Vec2(static_cast<Scalar>(left) + half(), static_cast<Scalar>(top) + half()); }
  /// Half the side with a margin around it, all of which must be on the wall.
  Scalar reach() const;
};

/// Obstacles before a wall: no patch begins where one is seen.
struct PatchObstacles {
  static constexpr int kMax = 128;
  int count = 0;
  Vec2 pixel[kMax];

  void add(const Vec2& at) {
    if (count < kMax) pixel[count++] = at;
  }
  /// Whether an obstacle is in the square, or just beside it.
  bool are_in(const PatchSquare& square) const;
};

/// Lists pixels of this frame's features that the gate of the wall rejects, and of places where patches of it were found elsewhere.
PatchObstacles find_obstacles(const Filter& filter, const Map& map, const Frame& frame, const PatchRefusals& refusals,
                              int wall);

}  // namespace pf
