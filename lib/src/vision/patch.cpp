#include "vision/patch.h"

#include <cmath>
#include <cstring>

namespace pf {

namespace {

constexpr Scalar kStepOfLevel1 = Scalar(1.6);

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

}  // namespace

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
  if (size < 1 || size > SourcePatch::kSize) return false;
  const Mat2& A = A_source_current;
  const Scalar step = std::sqrt(std::fmax(A.col(0).squaredNorm(), A.col(1).squaredNorm()));
  if (!(step < Scalar(1e3))) return false;
  const int l = step > kStepOfLevel1 ? 1 : 0;
  const Scalar per_level = l == 1 ? Scalar(0.5) : Scalar(1);
  const float a00 = static_cast<float>(A(0, 0) * per_level);
  const float a01 = static_cast<float>(A(0, 1) * per_level);
  const float a10 = static_cast<float>(A(1, 0) * per_level);
  const float a11 = static_cast<float>(A(1, 1) * per_level);

  // The corners are the furthest out: with them inside, all is.
  const float c = 0.5f * static_cast<float>(size - 1);
  const float reach_x = c * (std::fabs(a00) + std::fabs(a01));
  const float reach_y = c * (std::fabs(a10) + std::fabs(a11));
  constexpr float kSlack = 1e-3f;  // of rounding, so that a reading just beyond the last pixel is none of it
  const float x0 = patch.centre_x[l];
  const float y0 = patch.centre_y[l];
  if (!(x0 - reach_x >= static_cast<float>(patch.begin_x[l]) - kSlack &&
        y0 - reach_y >= static_cast<float>(patch.begin_y[l]) - kSlack &&
        x0 + reach_x <= static_cast<float>(patch.end_x[l] - 1) + kSlack &&
        y0 + reach_y <= static_cast<float>(patch.end_y[l] - 1) + kSlack)) {
    return false;
  }
  constexpr int kSize = SourcePatch::kSize;
  const std::uint8_t* pixels = patch.pixels[l];
  for (int j = 0; j < size; ++j) {
    const float v = static_cast<float>(j) - c;
    for (int i = 0; i < size; ++i) {
      const float u = static_cast<float>(i) - c;
      const float x = x0 + (a00 * u + a01 * v);
      const float y = y0 + (a10 * u + a11 * v);
      const int ix = clamp(static_cast<int>(x), 0, kSize - 2);
      const int iy = clamp(static_cast<int>(y), 0, kSize - 2);
      const float fx = x - static_cast<float>(ix);
      const float fy = y - static_cast<float>(iy);
      const std::uint8_t* p = pixels + iy * kSize + ix;
      const float top = static_cast<float>(p[0]) + fx * static_cast<float>(p[1] - p[0]);
      const float bottom = static_cast<float>(p[kSize]) + fx * static_cast<float>(p[kSize + 1] - p[kSize]);
      out[j * size + i] = top + fy * (bottom - top);
    }
  }
  return true;
}

}  // namespace pf
