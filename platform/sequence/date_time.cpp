#include "date_time.h"

#include <algorithm>
#include <cstddef>

#include "numbers.h"

namespace pf::sequence {

namespace {

constexpr size_t kDate = 10;  // characters of 2011-09-26
constexpr int64_t kSecond = 1000000000, kMinute = 60, kHour = 3600, kDay = 86400;

/// Two or four digits, of at most so much.
bool read(std::string_view text, size_t at, size_t count, int64_t most, int64_t& value) {
  value = 0;
  if (text.size() < at + count) {
    return false;
  }
  for (size_t i = at; i < at + count; ++i) {
    if (text[i] < '0' || text[i] > '9') {
      return false;
    }
    value = 10 * value + (text[i] - '0');
  }
  return value <= most;
}

/// Days since 1970-01-01 of a date in the Gregorian calendar, with years that begin in March.
int64_t days_of(int64_t year, int64_t month, int64_t day) {
  const int64_t y = month > 2 ? year : year - 1;
  const int64_t m = month > 2 ? month - 3 : month + 9;
  return 365 * y + y / 4 - y / 100 + y / 400 + (153 * m + 2) / 5 + day - 1 - 719468;
}

/// Seconds behind UTC of "Z", "+02:00", " +0200" or nothing.
bool read_zone(std::string_view text, int64_t& seconds) {
  int64_t hours = 0, minutes = 0;
  seconds = 0;
  text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
  if (text.size() == 5 && (text[0] == '+' || text[0] == '-') && read(text, 1, 2, 14, hours) &&
      read(text, 3, 2, 59, minutes)) {
    seconds = (text[0] == '-' ? -1 : 1) * (kHour * hours + kMinute * minutes);
    return true;
  }
  if (text.empty() || text == "Z" || text == "z") {
    return true;
  }
  if (text.size() != 6 || (text[0] != '+' && text[0] != '-') || text[3] != ':' || !read(text, 1, 2, 14, hours) ||
      !read(text, 4, 2, 59, minutes)) {
    return false;
  }
  seconds = (text[0] == '-' ? -1 : 1) * (kHour * hours + kMinute * minutes);
  return true;
}

}  // namespace

bool is_date(std::string_view text) {
  int64_t year = 0, month = 0, day = 0;
  return text.size() == kDate && read(text, 0, 4, 2200, year) && text[4] == '-' && read(text, 5, 2, 12, month) &&
         text[7] == '-' && read(text, 8, 2, 31, day) && year >= 1970 && month > 0 && day > 0;
}

bool parse_date_time(std::string_view text, int64_t& t_ns) {
  if (text.size() < kDate + 9 || !is_date(text.substr(0, kDate))) {
    return false;
  }
  int64_t year = 0, month = 0, day = 0, hour = 0, minute = 0, zone = 0;
  read(text, 0, 4, 2200, year);
  read(text, 5, 2, 12, month);
  read(text, 8, 2, 31, day);
  std::string_view clock = text.substr(kDate);
  if (clock[0] != 'T' && clock[0] != 't' && clock[0] != ' ' && clock[0] != '\t') {
    return false;
  }
  clock.remove_prefix(clock.find_first_not_of("Tt \t") == std::string_view::npos ? 1
                                                                                 : clock.find_first_not_of("Tt \t"));
  if (!read(clock, 0, 2, 23, hour) || clock.size() < 8 || clock[2] != ':' || !read(clock, 3, 2, 59, minute) ||
      clock[5] != ':') {
    return false;
  }
  clock.remove_prefix(6);
  const size_t end = clock.find_first_not_of("0123456789.");
  int64_t seconds_ns = 0;
  if (!parse_seconds(clock.substr(0, end), seconds_ns) || seconds_ns < 0 || seconds_ns > 61 * kSecond ||
      !read_zone(end == std::string_view::npos ? std::string_view() : clock.substr(end), zone)) {
    return false;
  }
  t_ns = kSecond * (kDay * days_of(year, month, day) + kHour * hour + kMinute * minute - zone) + seconds_ns;
  return true;
}

}  // namespace pf::sequence
