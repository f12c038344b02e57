#include "numbers.h"

#include <charconv>
#include <limits>

namespace pf::sequence {

namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

std::string_view without_plus(std::string_view text) {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') {
    text.remove_prefix(1);
  }
  return text;
}

}  // namespace

bool parse_double(std::string_view text, double& value) {
  text = without_plus(text);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

bool parse_integer(std::string_view text, int64_t& value) {
  text = without_plus(text);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

bool parse_seconds(std::string_view text, int64_t& t_ns) {
  constexpr int64_t kSecond = 1000000000;
  text = without_plus(text);
  const bool negative = !text.empty() && text[0] == '-';
  if (negative) {
    text.remove_prefix(1);
  }
  const size_t dot = text.find('.');
  const std::string_view whole = text.substr(0, dot);
  const std::string_view part = dot == std::string_view::npos ? "" : text.substr(dot + 1);
  if (whole.empty() && part.empty()) {
    return false;
  }
  int64_t seconds = 0;
  for (char c : whole) {
    if (!is_digit(c) || seconds > std::numeric_limits<int64_t>::max() / kSecond / 10 - 1) {
      return false;
    }
    seconds = 10 * seconds + (c - '0');
  }
  int64_t nanoseconds = 0;
  int64_t unit = kSecond / 10;
  for (size_t i = 0; i < part.size(); ++i) {
    if (!is_digit(part[i])) {
      return false;
    }
    if (i < 9) {
      nanoseconds += unit * (part[i] - '0');
      unit /= 10;
    } else if (i == 9) {
      nanoseconds += part[i] >= '5' ? 1 : 0;
    }
  }
  t_ns = seconds * kSecond + nanoseconds;
  t_ns = negative ? -t_ns : t_ns;
  return true;
}

}  // namespace pf::sequence
