#pragma once

#include "vision/image.h"
#include "vision/image_mask.h"

namespace pf {

/// How much there is to see in a frame.
struct FrameStatistics {
  float mean = 0;             // [grey]
  float deviation = 0;        // standard [grey]
  float gradient_energy = 0;  // mean of the squared differences to the right and lower neighbour [grey²]
};

/// Meant for level 2 of a pyramid. Zero throughout for images below 2x2. About 0.3 ns per pixel.
FrameStatistics frame_statistics(const ImageView& image);
/// The same of what a mask leaves of level `level` of a pyramid; deviation from the mean of the squares.
FrameStatistics frame_statistics(const ImageView& image, int level, const ImageMask& mask);

/// Whether features can be found and measured in a frame.
enum class FrameUse { kUsable, kDark, kBright, kFlat };

/// Black, white, or nothing but noise and blur, judged on level 2, where a wall's own texture or a lamp in a dark room
/// is still more than this.
FrameUse judge_frame(const FrameStatistics& statistics);

}  // namespace pf
