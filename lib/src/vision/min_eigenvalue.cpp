#include "vision/min_eigenvalue.h"

#include <cmath>

#include "vision/corners.h"
#include "vision/simd.h"

namespace pf {

namespace {

constexpr int kHalf = 3;

float smaller_eigenvalue(int xx, int xy, int yy) {
  constexpr float kScale = 1.0f / (4.0f * (2 * kHalf + 1) * (2 * kHalf + 1));
  const float a = static_cast<float>(xx) * kScale;
  const float b = static_cast<float>(xy) * kScale;
  const float c = static_cast<float>(yy) * kScale;
  const float smaller = 0.5f * ((a + c) - std::sqrt((a - c) * (a - c) + 4.0f * b * b));
  return smaller > 0.0f ? smaller : 0.0f;
}

float eigenvalue_plain(const std::uint8_t* centre, std::ptrdiff_t stride) {
  int xx = 0;
  int xy = 0;
  int yy = 0;
  for (int j = -kHalf; j <= kHalf; ++j) {
    const std::uint8_t* row = centre + j * stride;
    for (int i = -kHalf; i <= kHalf; ++i) {
      const int gx = row[i + 1] - row[i - 1];
      const int gy = row[i + stride] - row[i - stride];
      xx += gx * gx;
      xy += gx * gy;
      yy += gy * gy;
    }
  }
  return smaller_eigenvalue(xx, xy, yy);
}

}  // namespace

// Eight columns are read and the eighth is masked out; that is why the border is 5 and not 4.
float min_eigenvalue_at(const std::uint8_t* centre, std::ptrdiff_t stride) {
#if defined(PF_VISION_SSE2)
  const __m128i zero = _mm_setzero_si128();
  const __m128i seven = _mm_setr_epi16(-1, -1, -1, -1, -1, -1, -1, 0);
  const auto read = [zero](const std::uint8_t* p) {
    return _mm_unpacklo_epi8(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(p)), zero);
  };
  __m128i xx = zero;
  __m128i xy = zero;
  __m128i yy = zero;
  for (int j = -kHalf; j <= kHalf; ++j) {
    const std::uint8_t* row = centre + j * stride - kHalf;
    const __m128i gx = _mm_and_si128(seven, _mm_sub_epi16(read(row + 1), read(row - 1)));
    const __m128i gy = _mm_and_si128(seven, _mm_sub_epi16(read(row + stride), read(row - stride)));
    xx = _mm_add_epi32(xx, _mm_madd_epi16(gx, gx));
    xy = _mm_add_epi32(xy, _mm_madd_epi16(gx, gy));
    yy = _mm_add_epi32(yy, _mm_madd_epi16(gy, gy));
  }
  const auto total = [](__m128i v) {
    v = _mm_add_epi32(v, _mm_shuffle_epi32(v, 0x4e));
    return _mm_cvtsi128_si32(_mm_add_epi32(v, _mm_shuffle_epi32(v, 0xb1)));
  };
  return smaller_eigenvalue(total(xx), total(xy), total(yy));
#elif defined(PF_VISION_NEON)
  static constexpr std::int16_t kSeven[8] = {-1, -1, -1, -1, -1, -1, -1, 0};
  const int16x8_t seven = vld1q_s16(kSeven);
  int32x4_t xx = vdupq_n_s32(0);
  int32x4_t xy = vdupq_n_s32(0);
  int32x4_t yy = vdupq_n_s32(0);
  for (int j = -kHalf; j <= kHalf; ++j) {
    const std::uint8_t* row = centre + j * stride - kHalf;
    const int16x8_t gx = vandq_s16(seven, vreinterpretq_s16_u16(vsubl_u8(vld1_u8(row + 1), vld1_u8(row - 1))));
    const int16x8_t gy =
        vandq_s16(seven, vreinterpretq_s16_u16(vsubl_u8(vld1_u8(row + stride), vld1_u8(row - stride))));
    xx = vmlal_s16(vmlal_s16(xx, vget_low_s16(gx), vget_low_s16(gx)), vget_high_s16(gx), vget_high_s16(gx));
    xy = vmlal_s16(vmlal_s16(xy, vget_low_s16(gx), vget_low_s16(gy)), vget_high_s16(gx), vget_high_s16(gy));
    yy = vmlal_s16(vmlal_s16(yy, vget_low_s16(gy), vget_low_s16(gy)), vget_high_s16(gy), vget_high_s16(gy));
  }
  const auto total = [](int32x4_t v) {
    const int32x2_t half = vadd_s32(vget_low_s32(v), vget_high_s32(v));
    return vget_lane_s32(vpadd_s32(half, half), 0);
  };
  return smaller_eigenvalue(total(xx), total(xy), total(yy));
#else
  return eigenvalue_plain(centre, stride);
#endif
}

float min_eigenvalue(const ImageView& image, int x, int y) {
  if (!image.contains(x, y, kCornerBorder)) return 0.0f;
  return min_eigenvalue_at(image.pixel(x, y), image.stride);
}

float min_eigenvalue_reference(const ImageView& image, int x, int y) {
  if (!image.contains(x, y, kCornerBorder)) return 0.0f;
  return eigenvalue_plain(image.pixel(x, y), image.stride);
}

}  // namespace pf
