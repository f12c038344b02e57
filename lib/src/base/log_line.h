#pragma once

#include <cstdint>
#include <type_traits>

/// Lines of the log, built in place from texts and numbers. Nothing here allocates, prints, or depends on a locale.

namespace pf {

/// A real number in a line, rounded to `digits` (0 .. 6) after the point.
struct Fixed {
  double value = 0;
  int digits = 0;
};

template <class Real>
Fixed fixed(Real value, int digits) {
  return {static_cast<double>(value), digits};
}

/// An angle in a line, in degrees.
template <class Real>
Fixed degrees(Real rad, int digits = 1) {
  return fixed(static_cast<double>(rad) * 57.29577951308232, digits);
}

/// A text, a whole number or a real one: a part of a line.
class LogPart {
 public:
  LogPart(const char* text) : text_(text) {}
  LogPart(const Fixed& real) : real_(real.value), kind_(Kind::kReal), digits_(static_cast<std::int8_t>(real.digits)) {}
  template <class Int, class = std::enable_if_t<std::is_integral_v<Int>>>
  LogPart(Int whole) : whole_(static_cast<std::int64_t>(whole)), kind_(Kind::kWhole) {
    static_assert(!std::is_same_v<Int, bool> && !std::is_same_v<Int, char>, "has no digits");
    static_assert(sizeof(Int) < sizeof(std::int64_t) || std::is_signed_v<Int>, "may not fit");
  }

 private:
  friend class LogLine;
  enum class Kind : std::uint8_t { kText, kWhole, kReal };

  union {
    const char* text_;
    std::int64_t whole_;
    double real_;
  };
  Kind kind_ = Kind::kText;
  std::int8_t digits_ = 0;
};

/// A line of at most kMaxLength characters. A longer one is cut off, and ends in "...".
class LogLine {
 public:
  static constexpr int kMaxLength = 239;

  LogLine(const LogPart* part, int parts);
  const char* text() const { return text_; }

 private:
  void add(char c);
  void add(const char* text);
  /// At least min_digits digits, with zeros before them.
  void add_digits(std::uint64_t number, int min_digits);
  void add_whole(std::int64_t number);
  /// From 1e9 on with a power of ten (2.50e12), as are its digits then; "nan" and "inf" where it is not finite.
  void add_real(double real, int digits);

  char text_[kMaxLength + 1];
  int length_ = 0;
};

}  // namespace pf
