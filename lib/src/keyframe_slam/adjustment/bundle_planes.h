#pragma once

#include "keyframe_slam/adjustment/keyframe_bundle.h"
#include "keyframe_slam/planes/planes.h"

/// The planes of an adjustment, and the points on them.

namespace pf {

/// Adds points of the visible planes that the bundle's poses do not see, since they constrain these planes.
void add_plane_points(const KeyframeMap& map, AdjustedPoints* points);

/// Adds planes with enough points in the bundle. Points that do not fit are not held to them: those whose own pixels do not place them on
/// the plane within its roughness,
///
///   e² < gate (roughness² + (de/drho)² variance)
void add_planes(const KeyframeMap& map, const KeyframePlanes& planes, const FoldRule& fold, Scalar sigma_px,
                AdjustedPoints* points, AdjustedPlanes* adjusted);

}  // namespace pf
