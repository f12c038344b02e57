#pragma once

#include "bundle/start_bundle.h"
#include "geometry/camera.h"

namespace pf {

/// Whether the record's last frame shows that the camera stands where it stood in the first one, while something moves before it: at least
/// a third of the features are where they were, all over the image; the others are not both more and on more of it; and some of them have
/// moved, or the frame's estimated pose has turned with others that are not in the record (lib/docs/theory/starting.md). others: how many
/// such were matched in this frame.
bool stands_still(const Camera& camera, const StartRecord& record, int others);
/// Whether a feature is in the last frame where it was in the first one.
bool is_still(const Camera& camera, const StartRecord& record, int feature);

}  // namespace pf
