#include "vision/segment_test.h"

#include "vision/corners.h"
#include "vision/simd.h"

namespace pf {

namespace {

constexpr int kCircle = 16;
constexpr int kCircleX[kCircle] = {0, 1, 2, 3, 3, 3, 2, 1, 0, -1, -2, -3, -3, -3, -2, -1};
constexpr int kCircleY[kCircle] = {-3, -3, -2, -1, 0, 1, 2, 3, 3, 3, 2, 1, 0, -1, -2, -3};

struct Offsets {
  std::ptrdiff_t at[kCircle];
};

Offsets circle_offsets(std::ptrdiff_t stride) {
  Offsets out;
  for (int k = 0; k < kCircle; ++k) out.at[k] = kCircleY[k] * stride + kCircleX[k];
  return out;
}

/// Nine neighbours on the circle.
bool has_arc(std::uint32_t bits) {
  const std::uint32_t ring = bits | bits << kCircle;
  const std::uint32_t two = ring & ring >> 1;
  const std::uint32_t four = two & two >> 2;
  const std::uint32_t eight = four & four >> 4;
  return ((eight & ring >> 8) & 0xffffu) != 0;
}

bool test_pixel(const std::uint8_t* centre, const Offsets& offsets, int threshold) {
  std::uint32_t brighter = 0;
  std::uint32_t darker = 0;
  for (int k = 0; k < kCircle; ++k) {
    const int difference = centre[offsets.at[k]] - centre[0];
    if (difference > threshold) brighter |= 1u << k;
    if (difference < -threshold) darker |= 1u << k;
  }
  return has_arc(brighter) || has_arc(darker);
}

PF_ALWAYS_INLINE U8x16 smaller(const U8x16& a, const U8x16& b) {
#if defined(PF_VISION_SSE2)
  return (U8x16)_mm_min_epu8((__m128i)a, (__m128i)b);
#elif defined(PF_VISION_NEON)
  return (U8x16)vminq_u8((uint8x16_t)a, (uint8x16_t)b);
#else
  return a < b ? a : b;
#endif
}

PF_ALWAYS_INLINE U8x16 larger(const U8x16& a, const U8x16& b) {
#if defined(PF_VISION_SSE2)
  return (U8x16)_mm_max_epu8((__m128i)a, (__m128i)b);
#elif defined(PF_VISION_NEON)
  return (U8x16)vmaxq_u8((uint8x16_t)a, (uint8x16_t)b);
#else
  return a > b ? a : b;
#endif
}

PF_ALWAYS_INLINE bool any(const U8x16& mask) {
#if defined(PF_VISION_SSE2)
  return _mm_movemask_epi8((__m128i)mask) != 0;
#else
  const U64x2 halves = (U64x2)mask;
  return (halves[0] | halves[1]) != 0;
#endif
}

/// 16 pixels at once. An arc of 9 holds the arc of 8 that begins at its first even place, and one neighbour of that.
PF_ALWAYS_INLINE U8x16 has_arc(const U8x16 (&on)[kCircle]) {
  U8x16 two[8];
  U8x16 four[8];
  U8x16 found = {};
  for (int i = 0; i < 8; ++i) two[i] = on[2 * i] & on[2 * i + 1];
  for (int i = 0; i < 8; ++i) four[i] = two[i] & two[(i + 1) % 8];
  for (int i = 0; i < 8; ++i) {
    found |= four[i] & four[(i + 2) % 8] & (on[(2 * i + 8) % kCircle] | on[(2 * i + 15) % kCircle]);
  }
  return found;
}

/// Lanes that pass are not zero. Two neighbours on each of two crosses of the circle are needed for an arc of 9.
PF_ALWAYS_INLINE U8x16 test_block(const std::uint8_t* centre, const Offsets& offsets, const U8x16& threshold) {
  const U8x16 c = load<U8x16>(centre);
  const U8x16 high = smaller(c, 255 - threshold) + threshold;
  const U8x16 low = larger(c, threshold) - threshold;
  U8x16 maybe = {};
  maybe = ~maybe;
  for (int first = 0; first < 4; first += 2) {
    const U8x16 n = load<U8x16>(centre + offsets.at[first]);
    const U8x16 e = load<U8x16>(centre + offsets.at[first + 4]);
    const U8x16 s = load<U8x16>(centre + offsets.at[first + 8]);
    const U8x16 w = load<U8x16>(centre + offsets.at[first + 12]);
    const U8x16 bright = smaller(larger(n, s), larger(e, w));
    const U8x16 dark = larger(smaller(n, s), smaller(e, w));
    maybe &= (U8x16)(bright > high) | (U8x16)(dark < low);
    if (!any(maybe)) return maybe;
  }
  U8x16 on[kCircle];
  for (int k = 0; k < kCircle; ++k) on[k] = (U8x16)(load<U8x16>(centre + offsets.at[k]) > high);
  U8x16 found = has_arc(on);
  for (int k = 0; k < kCircle; ++k) on[k] = (U8x16)(load<U8x16>(centre + offsets.at[k]) < low);
  return found | has_arc(on);
}

}  // namespace

bool is_segment_corner(const ImageView& image, int x, int y, int threshold) {
  return test_pixel(image.pixel(x, y), circle_offsets(image.stride), threshold);
}

int segment_test_row_reference(const std::uint8_t* centre, std::ptrdiff_t stride, int count, int threshold,
                               std::uint16_t* list) {
  const Offsets offsets = circle_offsets(stride);
  int found = 0;
  for (int x = 0; x < count; ++x) {
    if (test_pixel(centre + x, offsets, threshold)) list[found++] = static_cast<std::uint16_t>(x);
  }
  return found;
}

int segment_test_row(const std::uint8_t* centre, std::ptrdiff_t stride, int count, int threshold, std::uint16_t* list) {
  if (count < 16) return segment_test_row_reference(centre, stride, count, threshold, list);
  const Offsets offsets = circle_offsets(stride);
  const U8x16 zero = {};
  const U8x16 t = zero + static_cast<std::uint8_t>(threshold);
  int found = 0;
  int next = 0;  // the last block reaches back over pixels that were already looked at
  while (next < count) {
    const int x = next + 16 <= count ? next : count - 16;
    const U8x16 mask = test_block(centre + x, offsets, t);
    if (any(mask)) {
      std::uint8_t lanes[16];
      store(lanes, mask);
      for (int k = next - x; k < 16; ++k) {
        if (lanes[k] != 0) list[found++] = static_cast<std::uint16_t>(x + k);
      }
    }
    next = x + 16;
  }
  return found;
}

}  // namespace pf
