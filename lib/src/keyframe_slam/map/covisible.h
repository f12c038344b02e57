#pragma once

#include "keyframe_slam/map/keyframe_map.h"

/// Which keyframes hang together.

namespace pf {

/// The keyframes that hang together with the newest one: each shares at least `least` points that have a depth with the others of them.
///
/// connected  gets one entry for each of the table
/// scratch    one for each point
/// returns    how many they are, the newest one included
///
/// Keyframes that are not connected have a scale and a place of their own: the adjustment does not constrain their scale against the rest.
int connected_keyframes(const KeyframeMap& map, int least, bool* connected, bool* scratch);

}  // namespace pf
