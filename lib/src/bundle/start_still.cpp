#include "bundle/start_still.h"

#include <algorithm>

#include "bundle/tuning.h"
#include "geometry/so3.h"

namespace pf {

using namespace tuning::start_still;

bool is_still(const Camera& camera, const StartRecord& record, int feature) {
  const int last = record.frames() - 1;
  Vec2 first;
  return last >= 0 && record.seen(last, feature) && project(camera, record.ray(feature), &first) &&
         (record.pixel(last, feature) - first).squaredNorm() <= kStillPx * kStillPx;
}

bool stands_still(const Camera& camera, const StartRecord& record, int others) {
  const int last = record.frames() - 1;
  if (last < 0) return false;
  const auto cell_along = [](Scalar at, int size, int cells) {
    return std::clamp(static_cast<int>(at * static_cast<Scalar>(cells)) / size, 0, cells - 1);
  };
  int seen = 0, still = 0, moved = 0, cells = 0, rows = 0, other_cells = 0;
  bool has_still[kRows][kColumns] = {}, row_has_still[kRows] = {}, has_other[kRows][kColumns] = {};
  const auto count_once = [](bool* counted, int* count) {
    *count += *counted ? 0 : 1;
    *counted = true;
  };
  for (int i = 0; i < record.features(); ++i) {
    Vec2 first;
    if (!record.seen(last, i) || !project(camera, record.ray(i), &first)) continue;
    ++seen;
    const bool stays = is_still(camera, record, i);
    const int row = cell_along(first.y(), camera.height, kRows);
    const int column = cell_along(first.x(), camera.width, kColumns);
    moved += (record.pixel(last, i) - first).squaredNorm() > kMovedPx * kMovedPx ? 1 : 0;
    count_once(stays ? &has_still[row][column] : &has_other[row][column], stays ? &cells : &other_cells);
    if (!stays) continue;
    ++still;
    count_once(&row_has_still[row], &rows);
  }
  if (kShare * still < seen || cells < kMinCells || rows < 2) return false;
  // The scene is what most features are on, and most of the picture. What stands still is else a mark on the picture.
  if (kMajority * still < seen && other_cells >= cells) return false;
  if (moved >= kMinMoved) return true;
  return others >= kMinMoved && log_so3(record.frame(last).q_WC).norm() * camera.fx > kTurnedPx;
}

}  // namespace pf
