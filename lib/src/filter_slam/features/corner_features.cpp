#include "filter_slam/features/corner_features.h"

#include "frame/corner_cells.h"
#include "frame/tuning.h"
#include "model/camera_at.h"

namespace pf {

void CornerFeatures::add() {
  CornerCells cells(settings_.camera.width, settings_.camera.height, settings_.border_px);
  if (settings_.features_in_view - cells.count(frame_) < tuning::image_corners::kMinNewFeatures) return;
  if (filter_.state().planes > 0) cells.mark_planes([&](const Vec2& pixel) { return features_.plane_at(pixel) >= 0; });
  int anchor = -1;
  cells.fill(settings_.features_in_view, settings_.min_inliers, frame_.report.frames, tuning::image_corners::kMaxInCell,
             [&](const Rect& cell, const CornerStrength& least) { return add_in(cell, least, &anchor); });
  if (anchor >= 0) filter_.remove(nullptr, 0);  // removes an anchor without children
}

void CornerFeatures::add_at(const Vec2* pixel, int count) {
  int anchor = -1;
  for (int i = 0; i < count; ++i)
    if (is_free(frame_, settings_.camera.width, pixel[i])) add_one(pixel[i], &anchor);
  if (anchor >= 0) filter_.remove(nullptr, 0);  // removes an anchor without children
}

/// Adds a feature at the best corner of this rectangle that is not near another feature. False: no such corner, or no room.
bool CornerFeatures::add_in(const Rect& rect, const CornerStrength& least, int* anchor) {
  return take_corner(search_.tracker(), rect, least, frame_, settings_.camera.width,
                     [&](const Vec2& pixel) { return add_one(pixel, anchor); });
}

CornerUse CornerFeatures::add_one(const Vec2& pixel, int* anchor) {
  if (frame_.full()) return CornerUse::kNoRoom;
  const int plane = features_.plane_at(pixel);
  if (!(plane >= 0 ? features_.make_room_on_plane() : features_.make_room_at(anchor))) return CornerUse::kNoRoom;
  const int entry = plane >= 0 ? features_.add_on_plane(plane, pixel, NoiseModel::reference())
                               : features_.add(*anchor, pixel, NoiseModel::reference());
  if (entry < 0) return CornerUse::kNotHere;
  const CameraAt camera = camera_at(filter_.state(), Scalar(0));
  if (!search_.remember(entry, pixel, {camera.q_WC, camera.p_W})) {
    features_.drop(&entry, 1);
    return CornerUse::kNotHere;
  }
  frame_.add({entry, map_.features[entry].id, MatchStatus::kNew, filter_.state().block[map_.features[entry].slot].kind,
              false, false, pixel, Mat2::Zero(), pixel, Scalar(0)});
  return CornerUse::kTaken;
}

}  // namespace pf
