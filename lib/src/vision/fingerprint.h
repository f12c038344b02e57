#pragma once

#include <cstdint>

#include "vision/image.h"

namespace pf {

/// 64 bits of an image's pixels. Equal images have equal fingerprints; two images that differ have the same one with a chance of
/// about 2^-64. For comparison within one run of a program only: the value depends on the byte order.
std::uint64_t fingerprint(const ImageView& image);

}  // namespace pf
