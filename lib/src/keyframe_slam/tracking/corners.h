#pragma once

#include "slam/image_search.h"
#include "slam/window_map.h"

namespace pf {

/// Adds points without a depth at corners of this frame's image, which is that of a keyframe, until enough are in view.
void add_corners(const Settings& settings, const ImageSearch& search, int keyframe, const Body& body, Scalar depth,
                 WindowMap* map, Frame* frame);

}  // namespace pf
