#pragma once

#include "base/archive.h"
#include "bundle/bundle.h"

namespace pf {

/// Archive. What a record or a keyframe holds has no class of noise.
inline void carry(Archive& archive, BundlePixel& pixel) {
  auto& [x, y, seen, sigma_class] = pixel;
  if (archive.is_reading()) pixel = {0, 0, false};
  archive.flags(seen);
  if (seen) archive.numbers(x, y);
}

}  // namespace pf
