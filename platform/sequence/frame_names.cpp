#include "frame_names.h"

#include <algorithm>
#include <cstdio>
#include <string_view>
#include <utility>

#include "name_stamps.h"
#include "numbers.h"

namespace pf::sequence {

std::string_view number_of(const std::string& name) {
  const size_t end = name.rfind('.');
  size_t begin = end;
  bool point = false;
  while (begin > 0) {
    const char c = name[begin - 1];
    if (c == '.' && !point && begin < end) {
      point = true;
    } else if (c < '0' || c > '9') {
      break;
    }
    --begin;
  }
  begin += begin < end && name[begin] == '.' ? 1 : 0;
  return std::string_view(name).substr(begin, end - begin);
}

namespace {

/// Whether digits behind points are fractions: all as many, or none with a zero at its end that print() would have dropped. Otherwise
/// they count, as 1.9, 1.10, 1.11.
bool are_fractions(const std::vector<std::string_view>& numbers) {
  size_t digits = std::string_view::npos;
  bool equal = true, some = false, dropped = true;
  for (const std::string_view number : numbers) {
    const size_t point = number.find('.');
    const size_t count = point == std::string_view::npos ? 0 : number.size() - point - 1;
    some = some || count > 0;
    equal = equal && (digits == std::string_view::npos || count == digits);
    digits = count;
    dropped = dropped && (count <= 1 || number.back() != '0');
  }
  return some && (dropped || (equal && digits > 1));
}

/// The numbers of names that begin alike; empty where a name has none, or they are several series.
std::vector<std::string_view> numbers_of(const std::vector<std::string>& names) {
  std::vector<std::string_view> numbers;
  for (const std::string& name : names) {
    numbers.push_back(number_of(name));
    const auto before = static_cast<size_t>(numbers.back().data() - name.data());
    const auto first = static_cast<size_t>(numbers[0].data() - names[0].data());
    if (numbers.back().empty() || name.compare(0, before, names[0], 0, first) != 0) {
      return {};
    }
  }
  return numbers;
}

/// Frames in the order of their times, which must differ; else empty.
std::vector<Frame> in_order(const fs::path& images, const std::vector<std::string>& names,
                            const std::vector<int64_t>& times) {
  std::vector<std::pair<int64_t, size_t>> order;
  for (size_t i = 0; i < times.size(); ++i) {
    order.emplace_back(times[i], i);
  }
  std::sort(order.begin(), order.end());
  std::vector<Frame> frames;
  for (const auto& [t_ns, i] : order) {
    if (!frames.empty() && t_ns <= frames.back().t_ns) {
      return {};
    }
    frames.push_back({t_ns, images / names[i]});
  }
  return frames;
}

}  // namespace

std::vector<Frame> frames_by_names(const fs::path& images, const std::vector<std::string>& names, double rate_hz,
                                   std::vector<std::string>& notes) {
  if (names.size() < 3) {
    return {};
  }
  const std::vector<Frame> dated = in_order(images, names, dates_in(names));
  if (!dated.empty()) {
    notes.push_back(
        images.string() +
        ": no times.txt; the dates in the names of the images are their times; a times.txt can say otherwise");
    return dated;
  }
  std::vector<std::string_view> numbers = numbers_of(names);
  const bool fractions = are_fractions(numbers);
  if (!fractions && (numbers.empty() || !are_stamps(numbers))) {
    numbers = stamps_in(names);
  }
  if (numbers.empty() || (!fractions && !are_stamps(numbers))) {
    return {};
  }
  std::vector<std::pair<int64_t, size_t>> order;
  for (size_t i = 0; i < names.size(); ++i) {
    int64_t value = 0;
    if (!parse_decimal(numbers[i], fractions ? 9 : 0, value)) {
      return {};
    }
    order.emplace_back(value, i);
  }
  std::sort(order.begin(), order.end());
  TimesAsWritten written{{}, fractions ? TimeUnit::kSeconds : TimeUnit::kNanoseconds, false, rate_hz};
  for (const auto& [value, i] : order) {
    written.words.push_back(numbers[i]);
  }
  std::string doubt;
  const TimeUnit unit = unit_of(written, doubt);
  const bool counted = !doubt.empty() && (unit == written.unit || unit == TimeUnit::kFrames);
  std::vector<Frame> frames;
  for (const auto& [value, i] : order) {
    int64_t t_ns = 0;
    if (counted) {
      parse_time(std::to_string(frames.size()), TimeUnit::kFrames, rate_hz, t_ns);
    } else if (!parse_time(numbers[i], unit, rate_hz, t_ns) || (!frames.empty() && t_ns <= frames.back().t_ns)) {
      return {};
    }
    frames.push_back({t_ns, images / names[i]});
  }
  char rate[64];
  std::snprintf(rate, sizeof(rate), "%g frames per second", rate_hz > 0.0 ? rate_hz : kAssumedRate);
  notes.push_back(images.string() + ": no times.txt; " +
                  (counted ? std::string("the images are sorted by the numbers in their names, and taken at ") + rate
                           : std::string("the names of the images are taken as times in ") + name_of(unit)) +
                  (doubt.empty() ? "" : " (" + doubt + ")") + "; a times.txt can say otherwise");
  return frames;
}

}  // namespace pf::sequence
