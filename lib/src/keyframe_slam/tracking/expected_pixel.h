#pragma once

#include "keyframe_slam/map/keyframe_map.h"
#include "keyframe_slam/tracking/pose_prior.h"

/// Where points of the window's map should appear in an image.

namespace pf {

/// Where a point is expected.
struct ExpectedPixel {
  Vec2 pixel;
  Mat2 spread;  ///< by pose and depth, without the noise of a match [px^2]
};

/// Of a point with a depth. False outside the camera's domain.
bool expect_placed(const KeyframeMap& map, int i, const PosePrior& at, ExpectedPixel* out);

/// Of a point without a depth: about its last pixel, for depths about the median:  rho = (1 +- kOpenSpread) / depth  along the ray on which
/// it was last seen. False outside the camera's domain.
bool expect_unplaced(const KeyframeMap& map, int i, const PosePrior& at, Scalar depth, ExpectedPixel* out);

}  // namespace pf
