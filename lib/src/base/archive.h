#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "base/eigen.h"

/// The live numbers of a context as bytes: counted, written, or read back with every one checked.

namespace pf {

/// Each class that keeps something between frames names it once, in carry(Archive&), for all three directions. Numbers are written as they
/// are in memory, so that only the build that wrote them reads them. Each has a domain, and what is not in it is never stored:
///
///   numbers   finite, within +-kMaxNumber; quaternions of length 1
///   counts    0 .. kMaxCount
///   within    integers and enumerations that are used as an index, or end a loop
///   flags     0 or 1
///   any       integers that may have every value, such as ids and times
///
/// After the first that is wrong nothing more is read, and failed() is true. Counts, indices and switches then get the least of their
/// domain, so that their owners, who check what they mean to each other, never follow what memory held before.
class Archive {
 public:
  static constexpr double kMaxNumber = 1e19;
  static constexpr std::int64_t kMaxCount = 1000000000;

  /// Counts.
  Archive() = default;
  static Archive writing(std::uint8_t* to, std::size_t bytes) { return Archive(to, nullptr, bytes); }
  static Archive reading(const std::uint8_t* from, std::size_t bytes) { return Archive(nullptr, from, bytes); }

  bool is_reading() const { return from_ != nullptr; }
  bool failed() const { return failed_; }
  std::size_t used() const { return used_; }
  bool is_at_end() const { return !failed_ && used_ == bytes_; }
  /// What has been read cannot be.
  void require(bool good) { failed_ = failed_ || !good; }

  template <typename... T>
  void numbers(T&... x) {
    (number(x), ...);
  }
  template <typename... T>
  void counts(T&... x) {
    (within(x, 0, kMaxCount), ...);
  }
  template <typename... T>
  void flags(T&... x) {
    (flag(x), ...);
  }
  template <typename... T>
  void any(T&... x) {
    (whole(x), ...);
  }
  template <typename T>
  void within(T& x, std::int64_t least, std::int64_t most) {
    static_assert(std::is_integral_v<T> || std::is_enum_v<T>);
    const std::int64_t read = integer(static_cast<std::int64_t>(x), static_cast<int>(sizeof(T)), least, most);
    if (is_reading()) x = static_cast<T>(read);
  }
  void bytes(std::uint8_t* x, std::size_t count) { copy(x, count); }

 private:
  Archive(std::uint8_t* to, const std::uint8_t* from, std::size_t bytes) : to_(to), from_(from), bytes_(bytes) {}

  void copy(void* x, std::size_t count);
  void reals(float* x, int count);
  void reals(double* x, int count);
  template <typename T>
  void reals_of(T* x, int count);
  std::int64_t integer(std::int64_t value, int size, std::int64_t least, std::int64_t most);
  template <typename Signed, typename Unsigned>
  std::int64_t integer_as(std::int64_t value, bool is_signed);

  void number(float& x) { reals(&x, 1); }
  void number(double& x) { reals(&x, 1); }
  template <typename D>
  void number(Eigen::PlainObjectBase<D>& x) {
    reals(x.data(), static_cast<int>(x.size()));
  }
  void number(Quat& x) {
    reals(x.coeffs().data(), 4);
    require(std::abs(x.squaredNorm() - Scalar(1)) < Scalar(0.1));
  }
  template <typename T, int kCount>
  void number(T (&x)[kCount]) {
    if constexpr (std::is_floating_point_v<T>)
      reals(x, kCount);
    else
      for (T& each : x) number(each);
  }
  template <typename T>
  void flag(T& x) {
    bool on = is_reading() ? false : x;  // what is read into may hold anything yet
    within(on, 0, 1);
    if (is_reading()) x = on;
  }
  template <typename T>
  void whole(T& x) {
    static_assert(std::is_integral_v<T>);
    copy(&x, sizeof x);
  }
  template <typename T, int kCount>
  void whole(T (&x)[kCount]) {
    static_assert(std::is_integral_v<T>);
    copy(x, sizeof x);
  }

  std::uint8_t* to_ = nullptr;
  const std::uint8_t* from_ = nullptr;
  std::size_t bytes_ = 0, used_ = 0;
  bool failed_ = false;
};

}  // namespace pf
