#pragma once

#include <algorithm>

#include "frame/frame.h"
#include "frame/tuning.h"
#include "track/tracker.h"

/// Where new features begin: at corners, in the cells of the image that hold the fewest. Knows no back end.

namespace pf {

class CornerCells {
 public:
  static constexpr int kColumns = 8, kRows = 6, kCells = kRows * kColumns;

  /// border_px: of the image, in which no feature begins.
  CornerCells(int width, int height, int border_px);

  /// Counts the features of a frame by where they are predicted. Returns how many of them are inliers.
  int count(const Frame& frame);
  /// Marks the cells that show a plane: is_on_plane(pixel) is called for a few pixels of each cell.
  template <typename F>
  void mark_planes(F&& is_on_plane);
  /// Adds features at plain corners until so many are in view; at faint corners too, where fewer than kFaintBelow times min_inliers (the
  /// least of a tracked frame) are. add_in(cell, least) adds one in a cell and returns whether it could. max_in_cell: features of a cell,
  /// one more where it shows a plane. turn: changes which cells come first.
  template <typename F>
  void fill(int in_view, int min_inliers, int turn, int max_in_cell, F&& add_in);

 private:
  template <typename F>
  void fill_cells(int in_view, int turn, int max_in_cell, F&& add_in);
  Rect rect_of(int row, int column) const;

  int width_, height_, border_;
  int in_view_ = 0;  ///< inliers, and features that this frame has added
  int in_cell_[kCells] = {};
  bool on_plane_[kCells] = {};
};

enum class CornerUse { kTaken, kNotHere, kNoRoom };

/// Least contrast of a corner.
struct CornerStrength {
  int threshold;  ///< of the segment test [grey levels]
  float score;    ///< min_eigenvalue
};
const CornerStrength kPlainCorner = {tuning::image_corners::kCornerThreshold, tuning::image_corners::kMinCornerScore};
/// For an image with too few plain corners: a dim one, or one of a bare wall.
const CornerStrength kFaintCorner = {tuning::image_corners::kFaintThreshold, tuning::image_corners::kFaintScore};

/// Calls take(pixel) for the corners of a cell that are near no feature of the frame, the best first, until it returns true. False: it
/// never did.
template <typename F>
bool take_corner(const Tracker& tracker, const Rect& cell, const CornerStrength& least, const Frame& frame, int width,
                 F&& take);

/// Whether no feature of this frame is near the pixel. width: of the image.
bool is_free(const Frame& frame, int width, const Vec2& pixel);

template <typename F>
void CornerCells::mark_planes(F&& is_on_plane) {
  constexpr int kAlong = 3;
  const Vec2 size(static_cast<Scalar>(width_) / kColumns, static_cast<Scalar>(height_) / kRows);
  for (int k = 0; k < kCells; ++k)
    for (int i = 0; i < kAlong * kAlong && !on_plane_[k]; ++i) {
      const Vec2 within((static_cast<Scalar>(i % kAlong) + Scalar(0.5)) / kAlong,
                        (static_cast<Scalar>(i / kAlong) + Scalar(0.5)) / kAlong);
      const Vec2 cell(static_cast<Scalar>(k % kColumns), static_cast<Scalar>(k / kColumns));
      on_plane_[k] = is_on_plane(Vec2(size.cwiseProduct(cell + within)));
    }
}

template <typename F>
void CornerCells::fill(int in_view, int min_inliers, int turn, int max_in_cell, F&& add_in) {
  fill_cells(in_view, turn, max_in_cell, [&](const Rect& cell) { return add_in(cell, kPlainCorner); });
  const int at_least = std::min(in_view, tuning::image_corners::kFaintBelow * min_inliers);
  fill_cells(at_least, turn, max_in_cell, [&](const Rect& cell) { return add_in(cell, kFaintCorner); });
}

/// Calls add_in(cell) for the emptiest cells until so many features are in view. Pass `level` takes the cells that hold that many features,
/// or kPlaneAhead more on a plane, where a feature has two rows and a known depth.
template <typename F>
void CornerCells::fill_cells(int in_view, int turn, int max_in_cell, F&& add_in) {
  const int kPlaneAhead = tuning::image_corners::kPlaneAhead;
  for (int level = -kPlaneAhead; level < max_in_cell && in_view_ < in_view; ++level) {
    for (int cell = 0; cell < kCells && in_view_ < in_view; ++cell) {
      // This order visits no neighbours one after the other.
      const int k = (cell * 19 + turn) % kCells;
      if (in_cell_[k] > max_in_cell || in_cell_[k] != level + (on_plane_[k] ? kPlaneAhead : 0)) continue;
      if (!add_in(rect_of(k / kColumns, k % kColumns))) continue;
      ++in_cell_[k];
      ++in_view_;
    }
  }
}

template <typename F>
bool take_corner(const Tracker& tracker, const Rect& cell, const CornerStrength& least, const Frame& frame, int width,
                 F&& take) {
  constexpr int kCorners = 8;
  Corner corner[kCorners];
  const int corners = tracker.corners(cell, least.threshold, corner, kCorners);
  for (int c = 0; c < corners; ++c) {
    if (corner[c].score < least.score) return false;
    const Vec2 pixel(static_cast<Scalar>(corner[c].x), static_cast<Scalar>(corner[c].y));
    if (!is_free(frame, width, pixel)) continue;
    const CornerUse use = take(pixel);
    if (use != CornerUse::kNotHere) return use == CornerUse::kTaken;
  }
  return false;
}

}  // namespace pf
