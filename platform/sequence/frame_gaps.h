#ifndef PLANEFOLD_PLATFORM_SEQUENCE_FRAME_GAPS_H
#define PLANEFOLD_PLATFORM_SEQUENCE_FRAME_GAPS_H

#include <string>
#include <vector>

#include "frame_table.h"

namespace pf::sequence {

/// What is missing among images that are counted by the numbers that end their names; "" where nothing is, or they do not count.
/// names  in their order
std::string missing_numbers(const std::vector<std::string>& names);

/// The longest interval between two frames, where it is of another kind than the others; "" where none is.
/// frames  in order of time
std::string longest_gap(const std::vector<Frame>& frames);

}  // namespace pf::sequence

#endif
