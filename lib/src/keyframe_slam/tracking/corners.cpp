#include "keyframe_slam/tracking/corners.h"

#include "base/table_entries.h"
#include "frame/corner_cells.h"
#include "keyframe_slam/map/rows.h"

namespace pf {
namespace {

/// Of the first frame the motion is not known; its pixels are corrected when they are seen again.
int add_at(int keyframe, const Body& body, Scalar depth, const Vec2& pixel, KeyframeMap* map) {
  const Keyframe& host = map->keyframes[keyframe];
  Vec3 ray_C;
  const bool has_ray = !map->keyframes.is_first(keyframe) && unproject(map->camera(), pixel, &ray_C);
  const Vec3 m = has_ray ? Vec3(host.q_WC * ray_C + host.p_W / depth) : Vec3::Zero();
  return map->add(keyframe, has_ray ? at_frame_time(map->camera(), body, m, 1 / depth, pixel) : pixel);
}

void note_new(const KeyframeMap& map, int i, const Vec2& pixel, Frame* frame) {
  frame->add(
      {i, map.feature(i).id, MatchStatus::kNew, map.kind(i), false, false, pixel, Mat2::Zero(), pixel, Scalar(0)});
}

}  // namespace

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
      const int i = add_at(keyframe, body, depth, pixel, map);
      if (i < 0) return CornerUse::kNoRoom;
      if (!search.remember(&map->tables(), i, pixel, {host.q_WC, host.p_W})) {
        map->drop(i);
        return CornerUse::kNotHere;
      }
      note_new(*map, i, pixel, frame);
      return CornerUse::kTaken;
    });
  };
  cells.fill(settings.features_in_view, settings.min_inliers, frame->report.frames, max_in_cell, add_in);
}

void add_given(const GivenPixels& given, int keyframe, const Body& body, Scalar depth, KeyframeMap* map, Frame* frame) {
  const FeatureTable& features = map->tables().features;
  for (int k = 0; k < given.count() && !frame->full(); ++k) {
    bool is_known = false;
    for (const int i : used_entries(features)) is_known = is_known || features[i].external_id == given[k].external_id;
    if (is_known) continue;
    const int i = add_at(keyframe, body, depth, given[k].pixel, map);
    if (i < 0) return;
    map->feature(i).external_id = given[k].external_id;
    note_new(*map, i, given[k].pixel, frame);
  }
}

}  // namespace pf
