#pragma once

#include "geometry/camera.h"
#include "map/tuning.h"
#include "map/wall_rays.h"
#include "vision/appearance.h"

/// What a frame says of a wall's place: points on it, behind it, and before it (lib/docs/theory/walls.md).

namespace pf {

/// The image in cells: those whose middle shows a wall, with no other before it, and those with points that do not lie on it.
class WallCover {
 public:
  template <class Where>
  WallCover(const PlaneTable& planes, const Where& where, int wall, const Camera& camera, const CameraView& view)
      : camera_(camera), view_(view) {
    for (int k = 0; k < kCells * kCells; ++k) {
      const Vec2 pixel((static_cast<Scalar>(k % kCells) + Scalar(0.5)) * static_cast<Scalar>(camera.width) / kCells,
                       (static_cast<Scalar>(k / kCells) + Scalar(0.5)) * static_cast<Scalar>(camera.height) / kCells);
      Vec3 ray_C;
      Scalar range = 0;
      if (unproject(camera, pixel, &ray_C) &&
          find_first_wall(planes, where, view.c_W, view.q_WC * ray_C, &range) == wall)
        wall_ |= 1u << k;
    }
  }
  void add(const Vec3& p_W);
  /// Whether at most half of what should show the wall is free of such points.
  bool is_wide() const { return 2 * bits(wall_ & hidden_) >= bits(wall_); }

 private:
  static constexpr int kCells = tuning::plane_doubt::kCells;
  static int bits(unsigned set);

  const Camera& camera_;
  CameraView view_;
  unsigned wall_ = 0, hidden_ = 0;
};

/// Points that are seen inside of a wall's outline.
struct WallVotes {
  int on = 0;              ///< that lie on it
  int off = 0;             ///< that the gate rejects
  int behind = 0;          ///< of these, through the wall
  bool hide_most = false;  ///< those that are off it leave too little of the wall to be seen

  /// By their distance d from the wall, positive before it, with its variance. Returns whether the point is off the wall.
  bool add(Scalar d, Scalar variance, Scalar gate);

  /// Whether they contradict the wall's place. Points behind it are seen through it. Points before it may be things that stand there, and
  /// count only where they leave too little of the wall to be seen.
  bool contradict(const PlaneEntry& wall) const;
  /// Whether they say that a rejected wall is where it should be.
  bool uphold() const { return on >= tuning::plane_doubt::kMinRefused && on > off; }
};

}  // namespace pf
