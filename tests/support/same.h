#pragma once

#include <cstdio>
#include <string>
#include <type_traits>
#include <utility>

#include "unity.h"

/// TEST_ASSERT_SAME(expected, actual): == holds, and where it does not the message has both values. For doubles and matrices that must not
/// differ in a single bit, and for enumerations.

namespace same {

template <typename T, typename = void>
struct IsMatrix : std::false_type {};
template <typename T>
struct IsMatrix<T, std::void_t<decltype(std::declval<const T&>().eval().coeff(0, 0))>> : std::true_type {};

template <typename T, typename = void>
struct IsList : std::false_type {};
template <typename T>
struct IsList<T, std::void_t<decltype(std::declval<const T&>().begin() != std::declval<const T&>().end())>>
    : std::true_type {};

template <typename T>
std::string text_of(const T& value) {
  if constexpr (std::is_enum_v<T>) {
    return std::to_string(static_cast<long long>(value));
  } else if constexpr (std::is_integral_v<T>) {
    return std::to_string(value);
  } else if constexpr (std::is_floating_point_v<T>) {
    char text[32];
    std::snprintf(text, sizeof text, "%.17g", static_cast<double>(value));
    return text;
  } else if constexpr (IsMatrix<T>::value) {
    const auto matrix = value.eval();
    std::string text = "[";
    for (int i = 0; i < matrix.rows(); ++i)
      for (int j = 0; j < matrix.cols(); ++j) text += (j > 0 ? " " : i > 0 ? "; " : "") + text_of(matrix.coeff(i, j));
    return text + "]";
  } else if constexpr (IsList<T>::value) {
    std::string text = "[";
    for (const auto& one : value) text += (text.size() > 1 ? " " : "") + text_of(one);
    return text + "]";
  } else {
    return "a value without text";
  }
}

template <typename Expected, typename Actual>
void check(const Expected& expected, const Actual& actual, const char* what, int line) {
  if (expected == actual) return;
  const std::string text = std::string(what) + ": expected " + text_of(expected) + " was " + text_of(actual);
  UNITY_TEST_FAIL(line, text.c_str());
}

}  // namespace same

#define TEST_ASSERT_SAME(expected, actual) same::check((expected), (actual), #actual, __LINE__)
