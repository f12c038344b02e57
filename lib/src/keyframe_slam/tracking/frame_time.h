#pragma once

#include <cstdint>

#include "frame/frame.h"
#include "keyframe_slam/map/keyframe_map.h"
#include "keyframe_slam/tracking/pose_prior.h"

/// Pixels of matches at the frame's time, where the camera reads its rows out one after the other (keyframe_slam/map/rows.h).

namespace pf {

/// Where a match would be at the frame's time, by the velocities of a pose. depth: of a point without one.
Vec2 match_at_frame_time(const KeyframeMap& map, const Match& match, const PosePrior& at, Scalar depth);

/// The same by how far its pixel has moved since it was last accepted, where velocities are not known yet. t_ns: the frame's.
///
///   z2 - z1 = u (dt + tau2 - tau1),   tau1 = 0 where z1 is at its frame's time
///
/// In the first keyframe the motion was not known, so its pixel is that of its row.
Vec2 followed_at_frame_time(const KeyframeMap& map, const Match& match, std::int64_t t_ns);

/// Counts a match that was found as an inlier of the frame at t_ns. pixel: at the frame's time; the point's last one from now on.
/// Where this is the second sight of a point of the first keyframe, its pixel there is taken to the keyframe's time by how far it has moved
/// since.
void accept_match(const CameraView& seen_from, const Vec2& pixel, std::int64_t t_ns, KeyframeMap* map, Match* match);

}  // namespace pf
