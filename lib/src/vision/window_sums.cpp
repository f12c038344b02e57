#include "vision/search.h"
#include "vision/simd.h"

namespace pf {

namespace {

constexpr int kSize = SearchTemplate::kSize;

void plain(const std::uint8_t* first, std::ptrdiff_t stride, int begin, int end, const SearchTemplate& pattern,
           const WindowSums& out) {
  for (int x = begin; x < end; ++x) {
    int sum = 0;
    int square = 0;
    int dot = 0;
    for (int j = 0; j < kSize; ++j) {
      const std::uint8_t* row = first + x + j * stride;
      for (int i = 0; i < kSize; ++i) {
        sum += row[i];
        square += row[i] * row[i];
        dot += row[i] * pattern.pixels[j * kSize + i];
      }
    }
    out.sum[x] = sum;
    out.square[x] = square;
    out.dot[x] = dot;
  }
}

}  // namespace

void window_sums_reference(const std::uint8_t* first, std::ptrdiff_t stride, int count, const SearchTemplate& pattern,
                           const WindowSums& out) {
  plain(first, stride, 0, count, pattern, out);
}

#if defined(PF_VISION_SSE2)

namespace {

/// Sums of the lanes of four vectors, as the lanes of one.
PF_ALWAYS_INLINE __m128i sum_lanes(const __m128i (&v)[4]) {
  const __m128i a = _mm_add_epi32(_mm_unpacklo_epi32(v[0], v[1]), _mm_unpackhi_epi32(v[0], v[1]));
  const __m128i b = _mm_add_epi32(_mm_unpacklo_epi32(v[2], v[3]), _mm_unpackhi_epi32(v[2], v[3]));
  return _mm_add_epi32(_mm_unpacklo_epi64(a, b), _mm_unpackhi_epi64(a, b));
}

}  // namespace

// Eight products of a row in one pmaddwd; four windows side by side so that their lanes are summed together.
void window_sums(const std::uint8_t* first, std::ptrdiff_t stride, int count, const SearchTemplate& pattern,
                 const WindowSums& out) {
  const __m128i zero = _mm_setzero_si128();
  const __m128i one = _mm_set1_epi16(1);
  __m128i t[kSize];
  for (int j = 0; j < kSize; ++j) {
    t[j] = _mm_unpacklo_epi8(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(pattern.pixels + j * kSize)), zero);
  }
  int x = 0;
  for (; x + 4 <= count; x += 4) {
    __m128i sum[4];
    __m128i square[4];
    __m128i dot[4];
    for (int k = 0; k < 4; ++k) {
      const std::uint8_t* p = first + x + k;
      __m128i s = zero;
      __m128i q = zero;
      __m128i d = zero;
      for (int j = 0; j < kSize; ++j) {
        const __m128i w =
            _mm_unpacklo_epi8(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(p + j * stride)), zero);
        s = _mm_add_epi16(s, w);
        q = _mm_add_epi32(q, _mm_madd_epi16(w, w));
        d = _mm_add_epi32(d, _mm_madd_epi16(w, t[j]));
      }
      sum[k] = _mm_madd_epi16(s, one);
      square[k] = q;
      dot[k] = d;
    }
    _mm_storeu_si128(reinterpret_cast<__m128i*>(out.sum + x), sum_lanes(sum));
    _mm_storeu_si128(reinterpret_cast<__m128i*>(out.square + x), sum_lanes(square));
    _mm_storeu_si128(reinterpret_cast<__m128i*>(out.dot + x), sum_lanes(dot));
  }
  plain(first, stride, x, count, pattern, out);
}

#elif defined(PF_VISION_NEON)

void window_sums(const std::uint8_t* first, std::ptrdiff_t stride, int count, const SearchTemplate& pattern,
                 const WindowSums& out) {
  uint8x8_t t[kSize];
  for (int j = 0; j < kSize; ++j) t[j] = vld1_u8(pattern.pixels + j * kSize);
  const auto total = [](uint32x4_t v) {
    const uint32x2_t half = vadd_u32(vget_low_u32(v), vget_high_u32(v));
    return static_cast<int>(vget_lane_u32(vpadd_u32(half, half), 0));
  };
  for (int x = 0; x < count; ++x) {
    uint16x8_t s = vdupq_n_u16(0);
    uint32x4_t q = vdupq_n_u32(0);
    uint32x4_t d = vdupq_n_u32(0);
    for (int j = 0; j < kSize; ++j) {
      const uint8x8_t w = vld1_u8(first + x + j * stride);
      s = vaddw_u8(s, w);
      q = vpadalq_u16(q, vmull_u8(w, w));
      d = vpadalq_u16(d, vmull_u8(w, t[j]));
    }
    out.sum[x] = total(vpaddlq_u16(s));
    out.square[x] = total(q);
    out.dot[x] = total(d);
  }
}

#else

void window_sums(const std::uint8_t* first, std::ptrdiff_t stride, int count, const SearchTemplate& pattern,
                 const WindowSums& out) {
  plain(first, stride, 0, count, pattern, out);
}

#endif

}  // namespace pf
