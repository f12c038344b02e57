#include <algorithm>

#include "filter/camera_at.h"
#include "slam/image_front_end.h"
#include "slam/tuning.h"

/// New features at corners of the image.

namespace pf {
namespace {

using namespace tuning::image_corners;

constexpr int kCellColumns = 8, kCellRows = 6, kCells = kCellRows * kCellColumns;

int cell_along(Scalar at, int size, int cells) {
  const Scalar inside = std::clamp(at, Scalar(0), static_cast<Scalar>(size - 1));
  return static_cast<int>(inside) * cells / size;
}

}  // namespace

void ImageFrontEnd::add_features() {
  int in_cell[kCells] = {};
  const int width = settings_.camera.width, height = settings_.camera.height;
  int in_view = 0;
  for (int t = 0; t < frame_.match_count(); ++t) {
    const Match& match = frame_.match(t);
    if (match.feature < 0) continue;
    const int row = cell_along(match.predicted.y(), height, kCellRows);
    ++in_cell[row * kCellColumns + cell_along(match.predicted.x(), width, kCellColumns)];
    if (match.status == MatchStatus::kInlier) ++in_view;
  }
  const int wanted = settings_.features_in_view - in_view;
  if (wanted < kMinNewFeatures) return;

  bool on_plane[kCells] = {};
  find_plane_cells(on_plane);
  const int border = std::max(settings_.border_px, 10);
  int anchor = -1, added = 0;
  // Emptiest cells first: pass `level` takes cells that hold that many features, or kPlaneAhead more on a plane, where one is cheap
  // and known at once.
  for (int level = -kPlaneAhead; level < kMaxInCell && added < wanted; ++level) {
    for (int cell = 0; cell < kCells && added < wanted; ++cell) {
      // This order visits no neighbours one after the other.
      const int k = (cell * 19 + frame_.report.frames) % kCells;
      const int row = k / kCellColumns, column = k % kCellColumns;
      if (in_cell[k] > kMaxInCell || in_cell[k] != level + (on_plane[k] ? kPlaneAhead : 0)) continue;
      Rect rect;
      rect.x = std::max(column * width / kCellColumns, border);
      rect.y = std::max(row * height / kCellRows, border);
      rect.width = std::min((column + 1) * width / kCellColumns, width - border) - rect.x;
      rect.height = std::min((row + 1) * height / kCellRows, height - border) - rect.y;
      if (!add_in(rect, &anchor)) continue;
      ++in_cell[k];
      ++added;
    }
  }
  if (anchor >= 0) filter_.remove(nullptr, 0);  // removes an anchor without children
}

/// Marks the cells of the image that show a plane on which features may begin, by a few pixels of each.
void ImageFrontEnd::find_plane_cells(bool* on_plane) const {
  constexpr int kAlong = 3;
  if (filter_.state().planes == 0) return;
  const Vec2 size(static_cast<Scalar>(settings_.camera.width) / kCellColumns,
                  static_cast<Scalar>(settings_.camera.height) / kCellRows);
  for (int k = 0; k < kCells; ++k)
    for (int i = 0; i < kAlong * kAlong && !on_plane[k]; ++i) {
      const Vec2 within((static_cast<Scalar>(i % kAlong) + Scalar(0.5)) / kAlong,
                        (static_cast<Scalar>(i / kAlong) + Scalar(0.5)) / kAlong);
      const Vec2 cell(static_cast<Scalar>(k % kCellColumns), static_cast<Scalar>(k / kCellColumns));
      on_plane[k] = features_.plane_at(size.cwiseProduct(cell + within)) >= 0;
    }
}

/// Adds a feature at the best corner of this rectangle that is not near another feature. False: no such corner, or no room.
bool ImageFrontEnd::add_in(const Rect& rect, int* anchor) {
  constexpr int kCorners = 8;
  Corner corner[kCorners];
  const int corners = tracker_.corners(rect, kCornerThreshold, corner, kCorners);
  for (int c = 0; c < corners; ++c) {
    if (corner[c].score < kMinCornerScore) return false;
    const Vec2 pixel(static_cast<Scalar>(corner[c].x), static_cast<Scalar>(corner[c].y));
    if (!is_free(pixel)) continue;
    if (frame_.full()) return false;
    const int plane = features_.plane_at(pixel);
    if (!(plane >= 0 ? features_.make_room_on_plane() : features_.make_room_at(anchor))) return false;
    const int entry = plane >= 0 ? features_.add_on_plane(plane, pixel, NoiseModel::reference())
                                 : features_.add(*anchor, pixel, NoiseModel::reference());
    if (entry < 0) continue;
    const CameraAt camera = camera_at(filter_.state(), Scalar(0));
    if (!remember(entry, pixel, {camera.q_WC, camera.p_W})) {
      features_.drop(&entry, 1);
      continue;
    }
    frame_.add({entry, map_.features[entry].id, MatchStatus::kNew,
                filter_.state().block[map_.features[entry].slot].kind, pixel, Mat2::Zero(), pixel, Scalar(0)});
    return true;
  }
  return false;
}

/// Whether no feature of this frame is near the pixel.
bool ImageFrontEnd::is_free(const Vec2& pixel) const {
  const Scalar apart = static_cast<Scalar>(std::max(8, settings_.camera.width / 40));
  for (int t = 0; t < frame_.match_count(); ++t) {
    const Match& match = frame_.match(t);
    if (match.feature >= 0 && !((match.predicted - pixel).squaredNorm() > apart * apart)) return false;
  }
  return true;
}

}  // namespace pf
