#ifndef PLANEFOLD_PLATFORM_SEQUENCE_FRAME_NAMES_H
#define PLANEFOLD_PLATFORM_SEQUENCE_FRAME_NAMES_H

#include <string>
#include <string_view>
#include <vector>

#include "frame_table.h"

namespace pf::sequence {

/// The number that a name ends with before its extension, with a decimal point where there is one: "rgb_12.05.png" to "12.05"; "" where it
/// ends with none. A part of name.
std::string_view number_of(const std::string& name);

/// Times in the names of images, as 12.05.png (seconds) or 1403636579763555584.png: frames in order of time. Empty where the names hold
/// no times.
std::vector<Frame> frames_by_names(const fs::path& images, const std::vector<std::string>& names, double rate_hz,
                                   std::vector<std::string>& notes);

}  // namespace pf::sequence

#endif
