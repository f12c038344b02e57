#include "vision/patch.h"

#include <cmath>
#include <cstring>

#include "vision/simd.h"

namespace pf {

namespace {

constexpr Scalar kStepOfLevel1 = Scalar(1.6);
constexpr float kMargin = 1e-3f;  // px

int clamp(int value, int low, int high) { return value < low ? low : value > high ? high : value; }

void extract_level(const ImageView& image, const Vec2& at, int l, SourcePatch* patch) {
  constexpr int kSize = SourcePatch::kSize;
  const int left = static_cast<int>(std::floor(at.x())) - (kSize / 2 - 1);
  const int top = static_cast<int>(std::floor(at.y())) - (kSize / 2 - 1);
  patch->centre_x[l] = static_cast<float>(at.x() - static_cast<Scalar>(left));
  patch->centre_y[l] = static_cast<float>(at.y() - static_cast<Scalar>(top));
  patch->begin_x[l] = static_cast<std::uint8_t>(clamp(-left, 0, kSize));
  patch->begin_y[l] = static_cast<std::uint8_t>(clamp(-top, 0, kSize));
  patch->end_x[l] = static_cast<std::uint8_t>(clamp(image.width - left, 0, kSize));
  patch->end_y[l] = static_cast<std::uint8_t>(clamp(image.height - top, 0, kSize));
  const int begin = patch->begin_x[l];
  const int end = patch->end_x[l];
  for (int j = 0; j < kSize; ++j) {
    std::uint8_t* to = patch->pixels[l] + j * kSize;
    const std::uint8_t* from = image.row(clamp(top + j, 0, image.height - 1));
    if (end - begin == kSize) {
      std::memcpy(to, from + left, kSize);
    } else {
      for (int i = 0; i < kSize; ++i) to[i] = from[clamp(left + i, 0, image.width - 1)];
    }
  }
}

/// Four bilinear readings. Four neighbours make one number, which vectors then take apart.
PF_ALWAYS_INLINE F32x4 sample(const std::uint8_t* pixels, const F32x4& x, const F32x4& y) {
  constexpr int kSize = SourcePatch::kSize;
  const I32x4 ix = __builtin_convertvector(x, I32x4);
  const I32x4 iy = __builtin_convertvector(y, I32x4);
  const I32x4 at = iy * kSize + ix;
  U32x4 four;
  for (int k = 0; k < 4; ++k) {
    const std::uint8_t* p = pixels + at[k];
    const unsigned top = static_cast<unsigned>(p[0] | p[1] << 8);
    const unsigned bottom = static_cast<unsigned>(p[kSize] | p[kSize + 1] << 8);
    four[k] = top | bottom << 16;
  }
  const F32x4 fx = x - __builtin_convertvector(ix, F32x4);
  const F32x4 fy = y - __builtin_convertvector(iy, F32x4);
  const auto grey = [&four](int shift) { return __builtin_convertvector((I32x4)(four >> shift & 255), F32x4); };
  const F32x4 top = grey(0) + fx * (grey(8) - grey(0));
  const F32x4 bottom = grey(16) + fx * (grey(24) - grey(16));
  return top + fy * (bottom - top);
}

/// How the template is read: level, and its step there.
struct Reading {
  int level;
  float a00, a01, a10, a11, centre;
};

bool choose_reading(const SourcePatch& patch, const Mat2& A, int size, Reading* r) {
  if (size < 1 || size > SourcePatch::kSize) return false;
  const Scalar step = std::sqrt(std::fmax(A.col(0).squaredNorm(), A.col(1).squaredNorm()));
  if (!(step < Scalar(1e3))) return false;
  const int l = step > kStepOfLevel1 ? 1 : 0;
  const Scalar per_level = l == 1 ? Scalar(0.5) : Scalar(1);
  const float c = 0.5f * static_cast<float>(size - 1);
  *r = {l,
        static_cast<float>(A(0, 0) * per_level),
        static_cast<float>(A(0, 1) * per_level),
        static_cast<float>(A(1, 0) * per_level),
        static_cast<float>(A(1, 1) * per_level),
        c};
  // The corners are the furthest out: with them inside, all is. The margin is for rounding on the way there, so that
  // no reading needs a check of its own.
  const float reach_x = c * (std::fabs(r->a00) + std::fabs(r->a01)) + kMargin;
  const float reach_y = c * (std::fabs(r->a10) + std::fabs(r->a11)) + kMargin;
  const float x0 = patch.centre_x[l], y0 = patch.centre_y[l];
  return x0 - reach_x >= static_cast<float>(patch.begin_x[l]) && y0 - reach_y >= static_cast<float>(patch.begin_y[l]) &&
         x0 + reach_x <= static_cast<float>(patch.end_x[l] - 1) &&
         y0 + reach_y <= static_cast<float>(patch.end_y[l] - 1);
}

}  // namespace

bool has_template(const SourcePatch& patch, const Mat2& A_source_current, int size) {
  Reading reading;
  return choose_reading(patch, A_source_current, size, &reading);
}

bool extract_source(const Pyramid& pyramid, const Vec2& pixel, SourcePatch* patch) {
  const ImageView& image = pyramid.level[0];
  const Scalar margin = kWarpSize / 2 + 1;
  // Written so that NaN fails.
  if (!(pixel.x() >= margin && pixel.y() >= margin && pixel.x() <= static_cast<Scalar>(image.width - 1) - margin &&
        pixel.y() <= static_cast<Scalar>(image.height - 1) - margin)) {
    return false;
  }
  for (int l = 0; l < SourcePatch::kLevels; ++l) {
    if (l < pyramid.levels) {
      extract_level(pyramid.level[l], to_level(pixel, l), l, patch);
    } else {
      std::memset(patch->pixels[l], 0, sizeof patch->pixels[l]);
      patch->centre_x[l] = patch->centre_y[l] = 0.0f;
      patch->begin_x[l] = patch->end_x[l] = patch->begin_y[l] = patch->end_y[l] = 0;
    }
  }
  return true;
}

bool warp_template(const SourcePatch& patch, const Mat2& A_source_current, int size, float* out) {
  Reading reading;
  if (!choose_reading(patch, A_source_current, size, &reading)) return false;
  const auto [l, a00, a01, a10, a11, c] = reading;
  const float x0 = patch.centre_x[l], y0 = patch.centre_y[l];
  const F32x4 lanes = {0.0f, 1.0f, 2.0f, 3.0f};
  for (int j = 0; j < size; ++j) {
    const float v = static_cast<float>(j) - c;
    const float row_x = x0 + (a01 * v - a00 * c);
    const float row_y = y0 + (a11 * v - a10 * c);
    float* row = out + j * size;
    int i = 0;
    for (; i + 4 <= size; i += 4) {
      const F32x4 at = lanes + static_cast<float>(i);
      store(row + i, sample(patch.pixels[l], row_x + a00 * at, row_y + a10 * at));
    }
    if (i == size) continue;
    const F32x4 at = smaller(lanes + static_cast<float>(i), F32x4{} + static_cast<float>(size - 1));
    const F32x4 values = sample(patch.pixels[l], row_x + a00 * at, row_y + a10 * at);
    for (int k = 0; i < size; ++i, ++k) row[i] = values[k];
  }
  return true;
}

}  // namespace pf
