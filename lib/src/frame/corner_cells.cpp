#include "frame/corner_cells.h"

#include <algorithm>

namespace pf {
namespace {

int cell_along(Scalar at, int size, int cells) {
  const Scalar inside = std::clamp(at, Scalar(0), static_cast<Scalar>(size - 1));
  return static_cast<int>(inside) * cells / size;
}

}  // namespace

CornerCells::CornerCells(int width, int height, int border_px)
    : width_(width), height_(height), border_(std::max(border_px, 10)) {}

int CornerCells::count(const Frame& frame) {
  int inliers = 0;
  for (int t = 0; t < frame.match_count(); ++t) {
    const Match& match = frame.match(t);
    if (match.feature < 0) continue;
    const int row = cell_along(match.predicted.y(), height_, kRows);
    ++in_cell_[row * kColumns + cell_along(match.predicted.x(), width_, kColumns)];
    if (match.status == MatchStatus::kInlier) ++inliers;
    if (match.status == MatchStatus::kNew) ++in_view_;
  }
  in_view_ += inliers;
  return inliers;
}

Rect CornerCells::rect_of(int row, int column) const {
  Rect rect;
  rect.x = std::max(column * width_ / kColumns, border_);
  rect.y = std::max(row * height_ / kRows, border_);
  rect.width = std::min((column + 1) * width_ / kColumns, width_ - border_) - rect.x;
  rect.height = std::min((row + 1) * height_ / kRows, height_ - border_) - rect.y;
  return rect;
}

bool is_free(const Frame& frame, int width, const Vec2& pixel) {
  const Scalar apart = static_cast<Scalar>(std::max(8, width / 40));
  for (int t = 0; t < frame.match_count(); ++t) {
    const Match& match = frame.match(t);
    if (match.feature >= 0 && !((match.predicted - pixel).squaredNorm() > apart * apart)) return false;
  }
  return true;
}

}  // namespace pf
