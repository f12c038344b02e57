#include "keyframe_slam/tracking/corners.h"

#include "frame/corner_cells.h"
#include "keyframe_slam/map/rows.h"

namespace pf {

void add_corners(const Settings& settings, const ImageSearch& search, int keyframe, const Body& body, Scalar depth,
                 KeyframeMap* map, Frame* frame) {
  CornerCells cells(settings.camera.width, settings.camera.height, settings.border_px);
  if (cells.count(*frame) >= settings.features_in_view) return;
  const Keyframe& host = map->keyframes[keyframe];
  // Three times as many as an even spread has.
  const int max_in_cell = 1 + 3 * settings.features_in_view / CornerCells::kCells;
  const auto add_in = [&](const Rect& cell, const CornerStrength& least) {
    return take_corner(search.tracker(), cell, least, *frame, settings.camera.width, [&](const Vec2& pixel) {
      if (frame->full()) return CornerUse::kNoRoom;
      Vec3 ray_C;
      // Of the first frame the motion is not known; its pixels are corrected when they are seen again.
      const bool has_ray = !map->keyframes.is_first(keyframe) && unproject(map->camera(), pixel, &ray_C);
      const Vec3 m = has_ray ? Vec3(host.q_WC * ray_C + host.p_W / depth) : Vec3::Zero();
      const int i = map->add(keyframe, has_ray ? at_frame_time(map->camera(), body, m, 1 / depth, pixel) : pixel);
      if (i < 0) return CornerUse::kNoRoom;
      if (!search.remember(&map->tables(), i, pixel, {host.q_WC, host.p_W})) {
        map->drop(i);
        return CornerUse::kNotHere;
      }
      frame->add(
          {i, map->feature(i).id, MatchStatus::kNew, map->kind(i), false, pixel, Mat2::Zero(), pixel, Scalar(0)});
      return CornerUse::kTaken;
    });
  };
  cells.fill(settings.features_in_view, settings.min_inliers, frame->report.frames, max_in_cell, add_in);
}

}  // namespace pf
