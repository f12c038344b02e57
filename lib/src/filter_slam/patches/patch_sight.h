#pragma once

#include "filter/filter.h"
#include "map/map.h"
#include "track/patch_store.h"

/// Where the filter expects a patch in the image.

namespace pf {

struct PatchSight {
  Mat3 H_CK;       ///< rays of the reference at depth 1 to rays of this image
  Vec2 corner[4];  ///< [px]
  Scalar cosine;   ///< between the view of its middle and the wall's normal
  Vec3 middle_W;
};

/// Middle of four corners.
inline Vec2 middle_of(const Vec2* corner) { return (corner[0] + corner[1] + corner[2] + corner[3]) / 4; }

/// Predicts a patch on a wall (entry of the table). False where a corner cannot be projected.
bool expect_patch(const Filter& filter, const PlaneTable& planes, const StoredPatch& patch, int wall,
                  PatchSight* sight);

/// Fits the homography to the corners of the sight.
bool fit_homography(const Camera& lens, const PlanePatch& pixels, PatchSight* sight);

/// Whether the patch's middle is in the image, and not too slanted.
bool is_in_view(const Camera& lens, const PatchSight& sight);

/// Whether all of the patch is in the image; one that is partly out is about to leave it.
bool is_whole_in_view(const Camera& lens, const PatchSight& sight);

/// The wall that the plan has between the camera and a patch on another one, or -1.
int hiding_wall(const Filter& filter, const Map& map, int wall, const PatchSight& sight);

}  // namespace pf
