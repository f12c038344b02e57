#ifndef PLANEFOLD_PLATFORM_SEQUENCE_NAME_STAMPS_H
#define PLANEFOLD_PLATFORM_SEQUENCE_NAME_STAMPS_H

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace pf::sequence {

/// Whether whole numbers are times since 1970 in milliseconds or finer: long, and no dates as 20240131120000.
bool are_stamps(const std::vector<std::string_view>& numbers);

/// The numbers of names of one kind that are times since 1970, wherever they stand: 1403636579763555584 of
/// 1403636579763555584_left.png. Empty where there are none, or several in a name.
std::vector<std::string_view> stamps_in(const std::vector<std::string>& names);

/// Nanoseconds since 1970 of the dates in names of one kind, with three, six or nine digits of seconds' fractions:
/// 2024-01-31_12-00-05.250.png, IMG_20240131_120005250.jpg. Empty where there are none, or one is no date.
std::vector<int64_t> dates_in(const std::vector<std::string>& names);

}  // namespace pf::sequence

#endif
