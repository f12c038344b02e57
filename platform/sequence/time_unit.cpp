#include "time_unit.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>

#include "date_time.h"
#include "numbers.h"

namespace pf::sequence {

namespace {

constexpr TimeUnit kUnits[] = {TimeUnit::kSeconds, TimeUnit::kMilliseconds, TimeUnit::kMicroseconds,
                               TimeUnit::kNanoseconds};
constexpr size_t kMinTimes = 3;  ///< fewer tell nothing of a rate
constexpr double kMaxRatio =
    10.0;  ///< of a rate to the calibration's: more is another unit, less may be frames left out
constexpr double kSureRatio = 3.0;   ///< of a rate to the calibration's, to take another unit than the layout's
constexpr double kSlowest = 0.2;     ///< [1/s] of a camera whose calibration says no rate
constexpr double kFastest = 2000.0;  ///< [1/s] likewise
constexpr double kMaxFrameNumber = 1e7;
constexpr double kMaxStride = 20.0;  ///< of frame numbers

/// 10^digits a second.
int digits_of(TimeUnit unit) {
  switch (unit) {
    case TimeUnit::kSeconds:
      return 0;
    case TimeUnit::kMilliseconds:
      return 3;
    case TimeUnit::kMicroseconds:
      return 6;
    default:
      return 9;
  }
}

std::string rate_text(double rate) {
  char text[32];
  if (rate >= 1000.0) {
    std::snprintf(text, sizeof(text), "%.0f Hz", rate);
  } else {
    std::snprintf(text, sizeof(text), "%.3g Hz", rate);
  }
  return text;
}

struct Steps {
  double median = 0.0;  ///< of the steps that grow
  bool counts = false;  ///< whole numbers, of which each is a frame's: small, and with small steps
  bool by_one = false;  ///< most steps are 1
};

Steps steps_of(const std::vector<std::string_view>& words) {
  std::vector<double> values, steps;
  bool whole = true;
  for (const std::string_view word : words) {
    double value = 0.0;
    if (!parse_double(word, value) || !std::isfinite(value)) {
      return {};  // the reader of the rows says what is wrong
    }
    whole = whole && word.find_first_of(".eE") == std::string_view::npos;
    values.push_back(value);
  }
  for (size_t i = 1; i < values.size(); ++i) {
    if (values[i] > values[i - 1]) {
      steps.push_back(values[i] - values[i - 1]);
    }
  }
  Steps found;
  if (steps.size() + 1 < kMinTimes) {
    return found;
  }
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  found.median = *middle;
  found.counts = whole && values.back() < kMaxFrameNumber && found.median <= kMaxStride;
  found.by_one = found.counts && found.median == 1.0;
  return found;
}

double ratio_of(double rate, double expected) { return std::max(rate / expected, expected / rate); }

/// The unit in which the rate is the one that is expected. false: none.
bool fitting_unit(double step, double rate_hz, TimeUnit& unit) {
  double best = std::numeric_limits<double>::max();
  for (const TimeUnit candidate : kUnits) {
    const double rate = std::pow(10.0, digits_of(candidate)) / step;
    const double expected = rate_hz > 0.0 ? rate_hz : kAssumedRate;
    const double ratio = ratio_of(rate, expected);
    if (ratio < best && ratio < (rate_hz > 0.0 ? kSureRatio : std::sqrt(1000.0))) {
      best = ratio;
      unit = candidate;
    }
  }
  return best < std::numeric_limits<double>::max();
}

}  // namespace

const char* name_of(TimeUnit unit) {
  switch (unit) {
    case TimeUnit::kSeconds:
      return "seconds";
    case TimeUnit::kMilliseconds:
      return "milliseconds";
    case TimeUnit::kMicroseconds:
      return "microseconds";
    case TimeUnit::kNanoseconds:
      return "nanoseconds";
    case TimeUnit::kFrames:
      break;
  }
  return "frame numbers";
}

const char* short_name_of(TimeUnit unit) {
  constexpr const char* kNames[] = {"s", "ms", "us", "ns", "frames"};
  return kNames[static_cast<size_t>(unit)];
}

bool parse_unit(std::string_view text, TimeUnit& unit) {
  const struct {
    const char* name;
    TimeUnit unit;
  } names[] = {{"s", TimeUnit::kSeconds},
               {"sec", TimeUnit::kSeconds},
               {"secs", TimeUnit::kSeconds},
               {"second", TimeUnit::kSeconds},
               {"seconds", TimeUnit::kSeconds},
               {"ms", TimeUnit::kMilliseconds},
               {"msec", TimeUnit::kMilliseconds},
               {"millis", TimeUnit::kMilliseconds},
               {"millisec", TimeUnit::kMilliseconds},
               {"millisecond", TimeUnit::kMilliseconds},
               {"milliseconds", TimeUnit::kMilliseconds},
               {"us", TimeUnit::kMicroseconds},
               {"\xc2\xb5s", TimeUnit::kMicroseconds},
               {"\xce\xbcs", TimeUnit::kMicroseconds},
               {"usec", TimeUnit::kMicroseconds},
               {"microsec", TimeUnit::kMicroseconds},
               {"microsecond", TimeUnit::kMicroseconds},
               {"microseconds", TimeUnit::kMicroseconds},
               {"ns", TimeUnit::kNanoseconds},
               {"nsec", TimeUnit::kNanoseconds},
               {"nanosec", TimeUnit::kNanoseconds},
               {"nanosecond", TimeUnit::kNanoseconds},
               {"nanoseconds", TimeUnit::kNanoseconds},
               {"frames", TimeUnit::kFrames},
               {"frame", TimeUnit::kFrames}};
  for (const auto& known : names) {
    if (text == known.name) {
      unit = known.unit;
      return true;
    }
  }
  return false;
}

bool parse_time(std::string_view word, TimeUnit unit, double rate_hz, int64_t& t_ns) {
  if (parse_date_time(word, t_ns)) {
    return true;
  }
  if (unit != TimeUnit::kFrames) {
    return parse_decimal(word, 9 - digits_of(unit), t_ns);
  }
  int64_t number = 0;
  if (!parse_integer(word, number) || std::llabs(number) > static_cast<int64_t>(kMaxFrameNumber)) {
    return false;
  }
  t_ns = std::llround(1e9 * static_cast<double>(number) / (rate_hz > 0.0 ? rate_hz : kAssumedRate));
  return true;
}

TimeUnit unit_of(const TimesAsWritten& times, std::string& note) {
  const Steps steps = steps_of(times.words);
  if (!(steps.median > 0.0) || times.unit == TimeUnit::kFrames) {
    return times.unit;
  }
  const double rate = std::pow(10.0, digits_of(times.unit)) / steps.median;
  const bool expected = times.rate_hz > 0.0;
  const bool possible = expected ? ratio_of(rate, times.rate_hz) <= kMaxRatio : rate >= kSlowest && rate <= kFastest;
  const bool numbers = steps.by_one && times.unit == TimeUnit::kSeconds && (!expected || times.rate_hz >= 3.0);
  if (times.said ? possible || !expected : possible && !numbers) {
    return times.unit;
  }
  note = "in " + std::string(name_of(times.unit)) + (times.said ? ", as its header says," : "") + " frames come at " +
         rate_text(rate);
  if (expected) {
    char text[64];
    std::snprintf(text, sizeof(text), ", but the calibration says rate_hz: %.6g", times.rate_hz);
    note += text;
  } else {
    note += possible ? ", and the times are whole numbers that count" : ", which is no camera's rate";
  }
  TimeUnit unit = times.unit;
  if (times.said) {
    note += "; one of the two is wrong";
    return unit;
  }
  if (!steps.by_one && fitting_unit(steps.median, times.rate_hz, unit) && unit != times.unit) {
    note += "; the times are taken as " + std::string(name_of(unit)) + " (" +
            rate_text(std::pow(10.0, digits_of(unit)) / steps.median) + ")";
    return unit;
  }
  if (steps.counts) {
    note += "; the times are taken as frame numbers at " + rate_text(expected ? times.rate_hz : kAssumedRate);
    return TimeUnit::kFrames;
  }
  note += "; they are taken as they are";
  return times.unit;
}

}  // namespace pf::sequence
