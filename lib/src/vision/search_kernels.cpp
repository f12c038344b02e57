#include "vision/search_kernels.h"

#include "vision/simd.h"

namespace pf {

namespace {

constexpr int kSize = SearchTemplate::kSize;

void plain_dots(const std::uint8_t* first, std::ptrdiff_t stride, int begin, int end, const SearchTemplate& pattern,
                std::uint32_t* dot) {
  for (int x = begin; x < end; ++x) {
    int total = 0;
    for (int j = 0; j < kSize; ++j) {
      const std::uint8_t* row = first + x + j * stride;
      for (int i = 0; i < kSize; ++i) total += row[i] * pattern.pixels[j * kSize + i];
    }
    dot[x] = static_cast<std::uint32_t>(total);
  }
}

}  // namespace

void window_dots_reference(const std::uint8_t* first, std::ptrdiff_t stride, int count, const SearchTemplate& pattern,
                           std::uint32_t* dot) {
  plain_dots(first, stride, 0, count, pattern, dot);
}

#if defined(PF_VISION_SSE2)

namespace {

PF_ALWAYS_INLINE __m128i widen_row(const std::uint8_t* p) {
  return _mm_unpacklo_epi8(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(p)), _mm_setzero_si128());
}

/// Sums of the lanes of four vectors, as the lanes of one.
PF_ALWAYS_INLINE __m128i sum_lanes(const __m128i& v0, const __m128i& v1, const __m128i& v2, const __m128i& v3) {
  const __m128i a = _mm_add_epi32(_mm_unpacklo_epi32(v0, v1), _mm_unpackhi_epi32(v0, v1));
  const __m128i b = _mm_add_epi32(_mm_unpacklo_epi32(v2, v3), _mm_unpackhi_epi32(v2, v3));
  return _mm_add_epi32(_mm_unpacklo_epi64(a, b), _mm_unpackhi_epi64(a, b));
}

}  // namespace

// Eight products of a row in one pmaddwd; four windows side by side so that their lanes are summed together.
void window_dots(const std::uint8_t* first, std::ptrdiff_t stride, int count, const SearchTemplate& pattern,
                 std::uint32_t* dot) {
  const __m128i zero = _mm_setzero_si128();
  __m128i t[kSize];
  for (int j = 0; j < kSize; ++j) t[j] = widen_row(pattern.pixels + j * kSize);
  int x = 0;
  for (; x + 4 <= count; x += 4) {
    const std::uint8_t* p = first + x;
    __m128i d0 = zero;
    __m128i d1 = zero;
    __m128i d2 = zero;
    __m128i d3 = zero;
    // Unrolled in full, the compiler loads everything first and runs out of registers.
#pragma GCC unroll 2
    for (int j = 0; j < kSize; ++j, p += stride) {
      d0 = _mm_add_epi32(d0, _mm_madd_epi16(widen_row(p), t[j]));
      d1 = _mm_add_epi32(d1, _mm_madd_epi16(widen_row(p + 1), t[j]));
      d2 = _mm_add_epi32(d2, _mm_madd_epi16(widen_row(p + 2), t[j]));
      d3 = _mm_add_epi32(d3, _mm_madd_epi16(widen_row(p + 3), t[j]));
    }
    _mm_storeu_si128(reinterpret_cast<__m128i*>(dot + x), sum_lanes(d0, d1, d2, d3));
  }
  for (; x < count; ++x) {
    __m128i d = zero;
    for (int j = 0; j < kSize; ++j) {
      d = _mm_add_epi32(d, _mm_madd_epi16(widen_row(first + x + j * stride), t[j]));
    }
    dot[x] = static_cast<std::uint32_t>(_mm_cvtsi128_si32(sum_lanes(d, zero, zero, zero)));
  }
}

#elif defined(PF_VISION_NEON)

void window_dots(const std::uint8_t* first, std::ptrdiff_t stride, int count, const SearchTemplate& pattern,
                 std::uint32_t* dot) {
  uint8x8_t t[kSize];
  for (int j = 0; j < kSize; ++j) t[j] = vld1_u8(pattern.pixels + j * kSize);
  for (int x = 0; x < count; ++x) {
    uint32x4_t d = vdupq_n_u32(0);
    for (int j = 0; j < kSize; ++j) d = vpadalq_u16(d, vmull_u8(vld1_u8(first + x + j * stride), t[j]));
    const uint32x2_t half = vadd_u32(vget_low_u32(d), vget_high_u32(d));
    dot[x] = vget_lane_u32(vpadd_u32(half, half), 0);
  }
}

#else

void window_dots(const std::uint8_t* first, std::ptrdiff_t stride, int count, const SearchTemplate& pattern,
                 std::uint32_t* dot) {
  plain_dots(first, stride, 0, count, pattern, dot);
}

#endif

void ColumnSums::begin(const std::uint8_t* first, std::ptrdiff_t stride, int count) {
  first_ = first;
  stride_ = stride;
  count_ = count;
  std::memset(sum_, 0, sizeof sum_);
  std::memset(square_, 0, sizeof square_);
  for (int j = 0; j < kSize; ++j) add(first + j * stride, nullptr);
}

void ColumnSums::move_down() {
  add(first_ + kSize * stride_, first_);
  first_ += stride_;
}

void ColumnSums::add(const std::uint8_t* in, const std::uint8_t* out) {
  const auto widen = [](const std::uint8_t* p) { return __builtin_convertvector(load<U8x8>(p), U16x8); };
  int c = 0;
  for (; c + 8 <= count_; c += 8) {
    const U16x8 a = widen(in + c);
    const U16x8 b = out != nullptr ? widen(out + c) : U16x8{};
    const U16x8 aa = a * a;
    const U16x8 bb = b * b;
    store(sum_ + c, load<U16x8>(sum_ + c) + a - b);
    store(square_ + c, load<U32x4>(square_ + c) + low_half(aa) - low_half(bb));
    store(square_ + c + 4, load<U32x4>(square_ + c + 4) + high_half(aa) - high_half(bb));
  }
  for (; c < count_; ++c) {
    const unsigned a = in[c];
    const unsigned b = out != nullptr ? out[c] : 0;
    sum_[c] = static_cast<std::uint16_t>(sum_[c] + a - b);
    square_[c] += a * a - b * b;
  }
}

void ColumnSums::windows(int k, int count, std::uint16_t* sum, std::uint32_t* square) const {
  for (int x = 0; x < count; x += 8) {
    U16x8 window = load<U16x8>(sum_ + k + x);
    for (int i = 1; i < kSize; ++i) window += load<U16x8>(sum_ + k + x + i);
    store(sum + x, window);
  }
  for (int x = 0; x < count; x += 4) {
    U32x4 window = load<U32x4>(square_ + k + x);
    for (int i = 1; i < kSize; ++i) window += load<U32x4>(square_ + k + x + i);
    store(square + x, window);
  }
}

}  // namespace pf
