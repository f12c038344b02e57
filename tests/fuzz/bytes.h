// Takes a fuzzer's bytes apart, one value after the other; zeros when they have run out.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>

class Bytes {
 public:
  Bytes(const uint8_t* data, size_t size) : data_(data), size_(size) {}

  bool empty() const { return size_ == 0; }

  template <class T>
  T take() {
    T value{};
    take(&value, sizeof(value));
    return value;
  }

  void take(void* out, size_t bytes) {
    const size_t n = bytes < size_ ? bytes : size_;
    std::memset(out, 0, bytes);
    if (n > 0) std::memcpy(out, data_, n);
    data_ += n;
    size_ -= n;
  }

 private:
  const uint8_t* data_;
  size_t size_;
};

/// Ends the run where the library broke its word.
inline void require(bool condition, const char* what) {
  if (condition) return;
  std::fprintf(stderr, "broken promise: %s\n", what);
  std::abort();
}
