#ifndef PLANEFOLD_PLATFORM_SEQUENCE_DATE_TIME_H
#define PLANEFOLD_PLATFORM_SEQUENCE_DATE_TIME_H

#include <cstdint>
#include <string_view>

namespace pf::sequence {

/// A date alone, as "2011-09-26".
bool is_date(std::string_view text);

/// "2011-09-26 13:02:25.964389445", with a T or a blank between, and Z or an offset from UTC as +02:00 behind it, to nanoseconds since
/// 1970. false: it is something else.
bool parse_date_time(std::string_view text, int64_t& t_ns);

}  // namespace pf::sequence

#endif
