#include "base/archive.h"

#include <cmath>
#include <cstring>

namespace pf {

void Archive::copy(void* x, std::size_t count) {
  if (to_ != nullptr || from_ != nullptr) require(count <= bytes_ - used_);
  if (failed_) return;
  if (to_ != nullptr) std::memcpy(to_ + used_, x, count);
  if (from_ != nullptr) std::memcpy(x, from_ + used_, count);
  used_ += count;
}

/// NaN is in no domain.
template <typename T>
void Archive::reals_of(T* x, int count) {
  for (int i = 0; i < count; ++i) {
    T value = x[i];
    copy(&value, sizeof value);
    require(std::abs(value) <= static_cast<T>(kMaxNumber));
    if (is_reading() && !failed_) x[i] = value;
  }
}

void Archive::reals(float* x, int count) { reals_of(x, count); }

void Archive::reals(double* x, int count) { reals_of(x, count); }

template <typename Signed, typename Unsigned>
std::int64_t Archive::integer_as(std::int64_t value, bool is_signed) {
  Signed bits = static_cast<Signed>(value);
  copy(&bits, sizeof bits);
  return is_signed ? std::int64_t{bits} : static_cast<std::int64_t>(static_cast<Unsigned>(bits));
}

std::int64_t Archive::integer(std::int64_t value, int size, std::int64_t least, std::int64_t most) {
  const bool is_signed = least < 0;
  const std::int64_t now = size == 8   ? integer_as<std::int64_t, std::uint64_t>(value, is_signed)
                           : size == 4 ? integer_as<std::int32_t, std::uint32_t>(value, is_signed)
                           : size == 2 ? integer_as<std::int16_t, std::uint16_t>(value, is_signed)
                                       : integer_as<std::int8_t, std::uint8_t>(value, is_signed);
  require(now >= least && now <= most);
  return failed_ ? least : now;
}

}  // namespace pf
