#pragma once

#include "keyframe_slam/map/keyframe_map.h"

namespace pf {

/// Column of an uncertain readout in the Jacobian of where a point of the map is expected, seen in row y by a camera at its frame's time
/// [px/s]: of that pixel, and of the bearing in the host, whose pixel was taken to its frame's time too (bundle/row_column.h):
///
///   u - J R_CW R_WH dr/dz u_H
///
/// rho  of the point along its bearing. Zero where it is not seen.
Vec2 expected_by_readout(const KeyframeMap& map, int point, const Body& at, Scalar rho, Scalar y);

/// Pixels of keyframes at their frames' times by another readout, which becomes that of the camera. Those of points without a depth are
/// taken there with the depth of their keyframe; depth: of one that has none.
void move_readout(Scalar readout, Scalar depth, KeyframeMap* map);

}  // namespace pf
