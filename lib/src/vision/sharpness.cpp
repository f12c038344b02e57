#include "vision/sharpness.h"

#include <algorithm>
#include <cmath>

namespace pf {

namespace {

constexpr int kFine = 1, kCoarse = 3;  // levels

struct GradientTensor {
  Scalar xx = 0, xy = 0, yy = 0;  // means of squares of differences over two pixels [grey²]

  Scalar determinant() const { return xx * yy - xy * xy; }
};

GradientTensor gradient_tensor(const ImageView& image) {
  std::uint64_t xx = 0, yy = 0;
  std::int64_t xy = 0;
  for (int y = 1; y + 1 < image.height; ++y) {
    const std::uint8_t *row = image.row(y), *above = image.row(y - 1), *below = image.row(y + 1);
    std::uint32_t row_xx = 0, row_yy = 0;  // one row of less than 33,000 pixels fits
    std::int32_t row_xy = 0;
    for (int x = 1; x + 1 < image.width; ++x) {
      const std::int32_t dx = row[x + 1] - row[x - 1], dy = below[x] - above[x];
      row_xx += static_cast<std::uint32_t>(dx * dx);
      row_yy += static_cast<std::uint32_t>(dy * dy);
      row_xy += dx * dy;
    }
    xx += row_xx;
    yy += row_yy;
    xy += row_xy;
  }
  const Scalar n = static_cast<Scalar>(image.width - 2) * static_cast<Scalar>(image.height - 2);
  return {static_cast<Scalar>(xx) / n, static_cast<Scalar>(xy) / n, static_cast<Scalar>(yy) / n};
}

}  // namespace

/// The ratio is the lesser root of det(T_1 - w T_3) = a w² - 2 b w + c, written without a difference of near numbers.
bool measure_sharpness(const Pyramid& pyramid, Scalar* log_sharpness) {
  if (pyramid.levels <= kCoarse) return false;
  const GradientTensor fine = gradient_tensor(pyramid.level[kFine]), coarse = gradient_tensor(pyramid.level[kCoarse]);
  const Scalar a = coarse.determinant(), c = fine.determinant();
  const Scalar b = (fine.xx * coarse.yy + fine.yy * coarse.xx) / 2 - fine.xy * coarse.xy;
  if (!(a > Scalar(0)) || !(c > Scalar(0)) || !(b > Scalar(0))) return false;
  const Scalar least = c / (b + std::sqrt(std::max(Scalar(0), b * b - a * c)));
  if (!(least > Scalar(0))) return false;
  *log_sharpness = std::log(least);
  return std::isfinite(*log_sharpness);
}

}  // namespace pf
