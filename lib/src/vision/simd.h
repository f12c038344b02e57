#pragma once

/// Vectors of 16 bytes: GCC's own, which every target has (as scalars where the processor has none), and the two
/// instruction sets that are the baseline of 64-bit processors, for what the language cannot say.
/// PLANEFOLD_PLAIN_VISION leaves the plain loops only.

#include <cstdint>
#include <cstring>

#if defined(PLANEFOLD_PLAIN_VISION)
#elif defined(__SSE2__)
#include <emmintrin.h>
#define PF_VISION_SSE2 1
#elif defined(__ARM_NEON)
#include <arm_neon.h>
#define PF_VISION_NEON 1
#endif

#define PF_ALWAYS_INLINE inline __attribute__((always_inline))

namespace pf {

typedef float F32x4 __attribute__((vector_size(16)));
typedef std::uint8_t U8x16 __attribute__((vector_size(16)));
typedef std::uint8_t U8x8 __attribute__((vector_size(8)));
typedef std::uint16_t U16x8 __attribute__((vector_size(16)));
typedef std::uint64_t U64x2 __attribute__((vector_size(16)));

/// No alignment is asked of the address.
template <typename V>
PF_ALWAYS_INLINE V load(const void* from) {
  V out;
  std::memcpy(&out, from, sizeof out);
  return out;
}

template <typename V>
PF_ALWAYS_INLINE void store(void* to, const V& value) {
  std::memcpy(to, &value, sizeof value);
}

PF_ALWAYS_INLINE float sum(const F32x4& v) { return (v[0] + v[2]) + (v[1] + v[3]); }

}  // namespace pf
