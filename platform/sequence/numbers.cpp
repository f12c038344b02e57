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

bool parse_decimal(std::string_view text, int digits, int64_t& value) {
  constexpr int64_t kMaxExponent = 64;
  constexpr int64_t kLargest = std::numeric_limits<int64_t>::max() / 10 - 1;
  text = without_plus(text);
  const bool negative = !text.empty() && text[0] == '-';
  if (negative) {
    text.remove_prefix(1);
  }
  const size_t e = text.find_first_of("eE");
  int64_t exponent = 0;
  if (e != std::string_view::npos &&
      (!parse_integer(text.substr(e + 1), exponent) || exponent > kMaxExponent || exponent < -kMaxExponent)) {
    return false;
  }
  text = text.substr(0, e);
  const size_t dot = text.find('.');
  const size_t before = dot == std::string_view::npos ? text.size() : dot;
  if (text.empty() || text == ".") {
    return false;
  }
  int64_t place = static_cast<int64_t>(before) + exponent + digits;  // of digits before the point of the result
  int64_t result = 0;
  bool up = false;
  for (size_t i = 0; i < text.size(); ++i) {
    if (i == dot) {
      continue;
    }
    if (!is_digit(text[i]) || (place > 0 && result > kLargest)) {
      return false;
    }
    if (place > 0) {
      result = 10 * result + (text[i] - '0');
    } else if (place == 0) {
      up = text[i] >= '5';
    }
    --place;
  }
  for (; place > 0 && result != 0; --place) {
    if (result > kLargest) {
      return false;
    }
    result *= 10;
  }
  result += up ? 1 : 0;
  value = negative ? -result : result;
  return true;
}

}  // namespace pf::sequence
