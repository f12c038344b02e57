#ifndef PLANEFOLD_PLATFORM_SEQUENCE_NUMBERS_H
#define PLANEFOLD_PLATFORM_SEQUENCE_NUMBERS_H

#include <cstdint>
#include <string_view>

namespace pf::sequence {

/// The whole text is one number; no locale. Accepts "nan" and "inf": the caller says what is absurd.
bool parse_double(std::string_view text, double& value);

/// The whole text is one integer.
bool parse_integer(std::string_view text, int64_t& value);

/// Decimal text, with or without an exponent, times 10^digits, exactly: digits beyond are rounded, nothing goes through a double.
/// digits  0 .. 9; false when the text is something else or the number does not fit.
bool parse_decimal(std::string_view text, int digits, int64_t& value);

/// Seconds in decimal text to nanoseconds, exactly.
inline bool parse_seconds(std::string_view text, int64_t& t_ns) { return parse_decimal(text, 9, t_ns); }

}  // namespace pf::sequence

#endif
