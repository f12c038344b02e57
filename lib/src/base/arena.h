#pragma once

#include <cstddef>
#include <cstdint>
#include <new>

#include "base/assert.h"

#if defined(__SANITIZE_ADDRESS__)
#define PF_HAS_RED_ZONES 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define PF_HAS_RED_ZONES 1
#endif
#endif
#if defined(PF_HAS_RED_ZONES)
#include <sanitizer/asan_interface.h>
#endif

namespace pf {

/// Hands out pieces of one block. The same layout function runs twice: over an arena without a block to count, and over
/// the caller's block to carve.
///
///   | piece | zone | piece | zone | ...        a zone only under AddressSanitizer, where it is poisoned
///
/// Pieces begin at multiples of kAlignment and are never returned. lib/docs/theory/memory.md.
class Arena {
 public:
  static constexpr std::size_t kAlignment = 64;

  Arena() = default;
  Arena(void* block, std::size_t bytes) : block_(static_cast<std::uint8_t*>(block)), capacity_(bytes) {}

  /// Null when counting, and when the block is too small: test ok() after the layout.
  template <typename T>
  T* take(std::size_t count) {
    const std::size_t bytes = count * sizeof(T);
    const std::size_t begin = used_;
    used_ = round_up(begin + bytes);
    const std::size_t zone = used_;
    used_ += kZone;
    if (block_ == nullptr || used_ > capacity_) return nullptr;
#if defined(PF_HAS_RED_ZONES)
    ASAN_UNPOISON_MEMORY_REGION(block_ + begin, bytes);
    ASAN_POISON_MEMORY_REGION(block_ + zone, kZone);
#else
    (void)zone;
#endif
    return reinterpret_cast<T*>(block_ + begin);
  }

  /// Constructs a T in a piece of the block and calls layout(T&), which takes the pieces that it holds. Null when counting: layout is then
  /// called with a T that goes away again.
  template <typename T, typename Layout, typename... Arguments>
  T* place(Layout&& layout, Arguments&... arguments) {
    T* const at = take<T>(1);
    if (at == nullptr) {
      T counted(arguments...);
      layout(counted);
      return nullptr;
    }
    T* const made = new (at) T(arguments...);
    layout(*made);
    return made;
  }

  std::size_t used() const { return used_; }
  bool ok() const { return block_ != nullptr && used_ <= capacity_; }

 private:
#if defined(PF_HAS_RED_ZONES)
  static constexpr std::size_t kZone = 64;
#else
  static constexpr std::size_t kZone = 0;
#endif
  static constexpr std::size_t round_up(std::size_t n) { return (n + kAlignment - 1) / kAlignment * kAlignment; }

  std::uint8_t* block_ = nullptr;
  std::size_t capacity_ = 0;
  std::size_t used_ = 0;
};

}  // namespace pf
