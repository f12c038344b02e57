#include "vision/pyramid.h"

#include "vision/simd.h"

namespace pf {

bool Pyramid::layout(Arena& arena, int width, int height, int wanted_levels) {
  levels = 0;
  if (width <= 0 || height <= 0 || wanted_levels <= 0) return false;
  int w = width;
  int h = height;
  for (int l = 0; l < wanted_levels && l < kMaxLevels; ++l) {
    if (l > 0) {
      w /= 2;
      h /= 2;
      if (w < kSmallestSide || h < kSmallestSide) break;
      const int stride = (w + 15) / 16 * 16;
      buffer_[l] = arena.take<std::uint8_t>(static_cast<std::size_t>(stride) * static_cast<std::size_t>(h));
      level[l] = ImageView{buffer_[l], w, h, stride};
    } else {
      level[0] = ImageView{nullptr, w, h, w};
    }
    levels = l + 1;
  }
  return true;
}

void Pyramid::build(const ImageView& image) {
  PF_ASSERT(image.width == level[0].width && image.height == level[0].height);
  level[0] = image;
  for (int l = 1; l < levels; ++l) halve(level[l - 1], buffer_[l], level[l].stride);
}

namespace {

void halve_row(const std::uint8_t* top, const std::uint8_t* bottom, std::uint8_t* to, int begin, int end) {
  for (int x = begin; x < end; ++x) {
    to[x] = static_cast<std::uint8_t>((top[2 * x] + top[2 * x + 1] + bottom[2 * x] + bottom[2 * x + 1] + 2) >> 2);
  }
}

}  // namespace

void halve_reference(const ImageView& from, std::uint8_t* to, int to_stride) {
  for (int y = 0; y < from.height / 2; ++y) {
    halve_row(from.row(2 * y), from.row(2 * y + 1), to + static_cast<std::ptrdiff_t>(y) * to_stride, 0, from.width / 2);
  }
}

// Neighbours sit in the two halves of a 16-bit lane, so that a mask and a shift take them apart, in either byte order.
void halve(const ImageView& from, std::uint8_t* to, int to_stride) {
  const int width = from.width / 2;
  for (int y = 0; y < from.height / 2; ++y) {
    const std::uint8_t* top = from.row(2 * y);
    const std::uint8_t* bottom = from.row(2 * y + 1);
    std::uint8_t* out = to + static_cast<std::ptrdiff_t>(y) * to_stride;
    int x = 0;
    for (; x + 16 <= width; x += 16) {
      const U16x8 a0 = load<U16x8>(top + 2 * x);
      const U16x8 a1 = load<U16x8>(top + 2 * x + 16);
      const U16x8 b0 = load<U16x8>(bottom + 2 * x);
      const U16x8 b1 = load<U16x8>(bottom + 2 * x + 16);
      const U16x8 s0 = ((a0 & 255) + (a0 >> 8) + (b0 & 255) + (b0 >> 8) + 2) >> 2;
      const U16x8 s1 = ((a1 & 255) + (a1 >> 8) + (b1 & 255) + (b1 >> 8) + 2) >> 2;
#if defined(PF_VISION_SSE2)
      _mm_storeu_si128(reinterpret_cast<__m128i*>(out + x), _mm_packus_epi16((__m128i)s0, (__m128i)s1));
#else
      store(out + x, __builtin_convertvector(s0, U8x8));
      store(out + x + 8, __builtin_convertvector(s1, U8x8));
#endif
    }
    halve_row(top, bottom, out, x, width);
  }
}

}  // namespace pf
