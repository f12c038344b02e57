// Memory for a context or an image of which nobody may touch more than was asked for.
#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <cstdint>

#include "base/arena.h"
#include "bytes.h"

constexpr size_t kPage = 4096;

/// Memory that ends, or begins, at a page that nobody may touch.
class Guarded {
 public:
  Guarded(size_t bytes, size_t alignment, bool at_end) : bytes_((bytes + alignment - 1) / alignment * alignment) {
    const size_t pages = (bytes_ + kPage - 1) / kPage;
    all_ = (pages + 2) * kPage;
    map_ = static_cast<uint8_t*>(mmap(nullptr, all_, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0));
    require(map_ != MAP_FAILED && mprotect(map_ + kPage, pages * kPage, PROT_READ | PROT_WRITE) == 0, "memory");
    begin_ = map_ + kPage + (at_end ? pages * kPage - bytes_ : 0);
  }
  Guarded(const Guarded&) = delete;
  Guarded& operator=(const Guarded&) = delete;
  ~Guarded() {
#if defined(PF_HAS_RED_ZONES)
    ASAN_UNPOISON_MEMORY_REGION(map_, all_);  // the next mapping may be at this address
#endif
    munmap(map_, all_);
  }
  uint8_t* begin() const { return begin_; }

  /// Red zones of the arena are read too, so that no sanitizer may look.
  __attribute__((no_sanitize("address", "undefined"))) uint64_t hash() const {
    using Word = uint64_t __attribute__((may_alias));
    const auto* words = static_cast<const volatile Word*>(static_cast<const volatile void*>(begin_));
    uint64_t h = 1469598103934665603u;
    for (size_t i = 0; i < bytes_ / sizeof(Word); ++i) {
      h = (h ^ words[i]) * 1099511628211u;
      h ^= h >> 29;
    }
    return h;
  }

 private:
  size_t bytes_, all_;
  uint8_t *map_, *begin_;
};
