#ifndef PLANEFOLD_PLATFORM_SEQUENCE_MASK_H
#define PLANEFOLD_PLATFORM_SEQUENCE_MASK_H

#include <cstdint>
#include <vector>

#include "file.h"

namespace pf::sequence {

/// Name of a mask that lies beside images, and is none of them.
constexpr const char* kMaskName = "mask.png";

/// The mask beside the frames of this path: in their folder, or where it lies, or in root. Empty: there is none.
fs::path find_mask(const fs::path& frame, const fs::path& root);

/// Grey levels 0 and 255 of a PNG of this size, row by row. Throws ReadError.
std::vector<std::uint8_t> read_mask(const fs::path& path, std::int32_t width, std::int32_t height);

}  // namespace pf::sequence

#endif
