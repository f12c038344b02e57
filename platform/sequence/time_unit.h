#ifndef PLANEFOLD_PLATFORM_SEQUENCE_TIME_UNIT_H
#define PLANEFOLD_PLATFORM_SEQUENCE_TIME_UNIT_H

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace pf::sequence {

enum class TimeUnit { kSeconds, kMilliseconds, kMicroseconds, kNanoseconds, kFrames };

const char* name_of(TimeUnit unit);
const char* short_name_of(TimeUnit unit);  ///< as parse_unit reads it

/// "s", "sec", "ms", "us", "ns" and their long names. false: none of them.
bool parse_unit(std::string_view text, TimeUnit& unit);

/// A time as it is written, or a date and time. Frames: at rate_hz. false: it is no number, or does not fit.
bool parse_time(std::string_view word, TimeUnit unit, double rate_hz, int64_t& t_ns);

/// Where the times of frames come from, and what is known of them.
struct TimesAsWritten {
  std::vector<std::string_view> words;  ///< numbers, in the order of the frames
  TimeUnit unit;                        ///< that the layout has
  bool said = false;                    ///< the table says its unit itself
  double rate_hz = 0.0;                 ///< of the calibration; 0: not said
};

/// The unit of times: the one that the layout has, unless frames would then come at an impossible rate, and another unit, or frame
/// numbers, gives the calibration's rate_hz (or, without it, the rate of a camera).
/// note  becomes the rates and the unit that is taken, where there is a doubt; else stays
TimeUnit unit_of(const TimesAsWritten& times, std::string& note);

constexpr double kAssumedRate = 30.0;  ///< [1/s] of frames without times where the calibration says none

}  // namespace pf::sequence

#endif
