#pragma once

/// Vectors of 16 bytes: GCC's own, which every target has (as scalars where the processor has none), and the two
/// instruction sets that are the baseline of 64-bit processors, for operations that the language does not have. PLANEFOLD_PLAIN_VISION
/// leaves the plain loops only.

#include <cstdint>
#include <cstring>

#include "base/always_inline.h"

#if defined(PLANEFOLD_PLAIN_VISION)
#elif defined(__SSE2__)
#include <emmintrin.h>
#define PF_VISION_SSE2 1
#elif defined(__ARM_NEON)
#include <arm_neon.h>
#define PF_VISION_NEON 1
#endif

namespace pf {

typedef float F32x4 __attribute__((vector_size(16)));
typedef std::uint8_t U8x16 __attribute__((vector_size(16)));
typedef std::uint8_t U8x8 __attribute__((vector_size(8)));
typedef std::uint16_t U16x8 __attribute__((vector_size(16)));
typedef std::uint16_t U16x4 __attribute__((vector_size(8)));
typedef std::uint32_t U32x4 __attribute__((vector_size(16)));
typedef std::int16_t I16x4 __attribute__((vector_size(8)));
typedef std::int32_t I32x4 __attribute__((vector_size(16)));
typedef std::uint64_t U64x2 __attribute__((vector_size(16)));

/// The address need not be aligned.
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

/// Lanes 0 .. 3 and 4 .. 7 as 32-bit numbers.
PF_ALWAYS_INLINE U32x4 low_half(const U16x8& v) {
#if defined(PF_VISION_SSE2)
  return (U32x4)_mm_unpacklo_epi16((__m128i)v, _mm_setzero_si128());
#else
  return U32x4{v[0], v[1], v[2], v[3]};
#endif
}
PF_ALWAYS_INLINE U32x4 high_half(const U16x8& v) {
#if defined(PF_VISION_SSE2)
  return (U32x4)_mm_unpackhi_epi16((__m128i)v, _mm_setzero_si128());
#else
  return U32x4{v[4], v[5], v[6], v[7]};
#endif
}

/// Products of lanes that are below 2^15: one instruction where a full 32-bit product takes six.
PF_ALWAYS_INLINE U32x4 multiply_small(const U32x4& a, const U32x4& b) {
#if defined(PF_VISION_SSE2)
  return (U32x4)_mm_madd_epi16((__m128i)a, (__m128i)b);
#else
  return a * b;
#endif
}

/// Correctly rounded in every lane.
PF_ALWAYS_INLINE F32x4 square_root(const F32x4& v) {
#if defined(PF_VISION_SSE2)
  return (F32x4)_mm_sqrt_ps((__m128)v);
#elif defined(PF_VISION_NEON) && defined(__aarch64__)
  return (F32x4)vsqrtq_f32((float32x4_t)v);
#else
  return F32x4{__builtin_sqrtf(v[0]), __builtin_sqrtf(v[1]), __builtin_sqrtf(v[2]), __builtin_sqrtf(v[3])};
#endif
}

PF_ALWAYS_INLINE F32x4 larger(const F32x4& a, const F32x4& b) {
#if defined(PF_VISION_SSE2)
  return (F32x4)_mm_max_ps((__m128)a, (__m128)b);
#else
  return a > b ? a : b;
#endif
}

PF_ALWAYS_INLINE F32x4 smaller(const F32x4& a, const F32x4& b) {
#if defined(PF_VISION_SSE2)
  return (F32x4)_mm_min_ps((__m128)a, (__m128)b);
#else
  return a < b ? a : b;
#endif
}

/// Lanes 0 and 2 of the one and then of the other; lanes 1 and 3.
PF_ALWAYS_INLINE F32x4 even_lanes(const F32x4& a, const F32x4& b) {
#if defined(__clang__)
  return __builtin_shufflevector(a, b, 0, 2, 4, 6);
#else
  return __builtin_shuffle(a, b, I32x4{0, 2, 4, 6});
#endif
}
PF_ALWAYS_INLINE F32x4 odd_lanes(const F32x4& a, const F32x4& b) {
#if defined(__clang__)
  return __builtin_shufflevector(a, b, 1, 3, 5, 7);
#else
  return __builtin_shuffle(a, b, I32x4{1, 3, 5, 7});
#endif
}

PF_ALWAYS_INLINE float sum(const F32x4& v) { return (v[0] + v[2]) + (v[1] + v[3]); }

}  // namespace pf
