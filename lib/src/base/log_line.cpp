#include "base/log_line.h"

#include <algorithm>
#include <cmath>

namespace pf {

LogLine::LogLine(const LogPart* part, int parts) {
  for (int k = 0; k < parts; ++k) {
    if (part[k].kind_ == LogPart::Kind::kText) add(part[k].text_);
    if (part[k].kind_ == LogPart::Kind::kWhole) add_whole(part[k].whole_);
    if (part[k].kind_ == LogPart::Kind::kReal) add_real(part[k].real_, part[k].digits_);
  }
  if (length_ > kMaxLength) {
    length_ = kMaxLength;
    std::fill(text_ + kMaxLength - 3, text_ + kMaxLength, '.');
  }
  text_[length_] = '\0';
}

void LogLine::add(char c) {
  if (length_ < kMaxLength) text_[length_] = c;
  if (length_ <= kMaxLength) ++length_;  // one beyond the end: it is cut off
}

void LogLine::add(const char* text) {
  for (; *text != '\0'; ++text) add(*text);
}

void LogLine::add_digits(std::uint64_t number, int min_digits) {
  constexpr int kMaxDigits = 20;
  char digit[kMaxDigits];
  int count = 0;
  for (; count < kMaxDigits && (number > 0 || count < min_digits); number /= 10)
    digit[count++] = static_cast<char>('0' + number % 10);
  while (count > 0) add(digit[--count]);
}

void LogLine::add_whole(std::int64_t number) {
  const auto bits = static_cast<std::uint64_t>(number);
  if (number < 0) add('-');
  add_digits(number < 0 ? 0 - bits : bits, 1);
}

void LogLine::add_real(double real, int digits) {
  constexpr double kLarge = 1e9;
  double size = std::abs(real);
  if (!std::isfinite(size)) return add(std::isnan(size) ? "nan" : real < 0 ? "-inf" : "inf");
  int exponent = 0;
  if (size >= kLarge)
    for (; size >= 10; size /= 10) ++exponent;
  digits = std::clamp(digits, 0, 6);
  std::uint64_t unit = 1;
  for (int k = 0; k < digits; ++k) unit *= 10;
  const auto number = static_cast<std::uint64_t>(size * static_cast<double>(unit) + 0.5);
  if (real < 0 && number > 0) add('-');
  add_digits(number / unit, 1);
  if (digits > 0) {
    add('.');
    add_digits(number % unit, digits);
  }
  if (exponent > 0) {
    add('e');
    add_whole(exponent);
  }
}

}  // namespace pf
