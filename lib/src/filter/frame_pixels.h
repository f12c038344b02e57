#pragma once

#include "filter/filter.h"

namespace pf {

/// Pixel of a feature, corrected to the frame's time for the readout of its row. The correction is the image's motion there, which is known
/// long before depths and speeds are.
Vec2 at_frame_time(const Filter& filter, int slot, const Vec2& measured);

}  // namespace pf
