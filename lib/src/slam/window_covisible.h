#pragma once

#include "slam/window_map.h"

/// Which keyframes hang together.

namespace pf {

/// Points with a depth that both keyframes saw.
int shared_points(const WindowMap& map, int a, int b);

/// The keyframes that a chain connects with the newest one, in which each shares at least `least` points with the one before.
///
/// connected  gets one entry for each of the table
/// returns    how many they are, the newest one included
///
/// What is connected no other way has a scale and a place of its own: nothing that is adjusted says how long its lengths are in those of
/// the rest.
int connected_keyframes(const WindowMap& map, int least, bool* connected);

}  // namespace pf
