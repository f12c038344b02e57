#pragma once

#include "frame/image_search.h"
#include "keyframe_slam/map/keyframe_map.h"
#include "map/given_pixels.h"

namespace pf {

/// Adds points without a depth at corners of this frame's image, which is that of a keyframe, until enough are in view.
void add_corners(const Settings& settings, const ImageSearch& search, int keyframe, const Body& body, Scalar depth,
                 KeyframeMap* map, Frame* frame);

/// The same at pixels of this frame that the caller gives, where they measure no point of the map yet, while there is room.
void add_given(const GivenPixels& given, int keyframe, const Body& body, Scalar depth, KeyframeMap* map, Frame* frame);

}  // namespace pf
