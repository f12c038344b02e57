#pragma once

#include "keyframe_slam/map/keyframe_map.h"

/// Adds and removes keyframes, and the points that belong to them.

namespace pf {

/// The one that leaves for the next: that sees the fewest points, but none of the newest `kept` ones. -1: there is room.
int leaving_keyframe(const KeyframeMap& map, int kept);
/// Its points go to the newest keyframe that saw them; where there is none they are dropped.
void remove_keyframe(int k, KeyframeMap* map);
/// Adds the pose as a keyframe with the frame's inliers. Where there is no room, leaving_keyframe() is removed. Returns the entry of the
/// new one.
int add_keyframe(const Frame& frame, const CameraView& view, int kept, KeyframeMap* map);
/// Removes all keyframes but the first, and the points that they host.
void keep_first_keyframe(KeyframeMap* map);

/// Drops points that fail too often, and those that are not in front of their hosts.
void drop_failing(KeyframeMap* map);
/// An adjustment has moved the newest keyframe from this view: the views from which points without a depth were last seen move with it.
void move_views(const CameraView& newest_before, KeyframeMap* map);
/// Number of points with a depth.
int num_placed(const KeyframeMap& map);

}  // namespace pf
