#include "vision/straight_edge.h"

#include <cstddef>
#include <cstdint>

namespace pf {
namespace {

constexpr int kHalf = 5;              ///< of the window
constexpr int kWide = 2 * kHalf + 3;  ///< pixels that its central differences read
constexpr int kTall = kWide + 4;      ///< and that the binomial reads for those
// Of the eigenvalues of a corner. An edge that pixels average has up to 0.004, one that nothing smooths up to 0.025.
constexpr float kLeastRatio = 0.02f;

/// 16 times the mean of five pixels, step apart, with the weights 1 4 6 4 1.
template <typename T>
int binomial(const T* at, std::ptrdiff_t step) {
  return at[-2 * step] + at[2 * step] + 4 * (at[-step] + at[step]) + 6 * at[0];
}

}  // namespace

bool is_on_straight_edge(const ImageView& image, int x, int y) {
  if (!image.contains(x, y, kStraightEdgeBorder)) return false;
  int along[kTall][kWide];  // smoothed along the rows
  for (int j = 0; j < kTall; ++j) {
    const std::uint8_t* row = image.pixel(x - kWide / 2, y + j - kTall / 2);
    for (int i = 0; i < kWide; ++i) along[j][i] = binomial(row + i, 1);
  }
  int smooth[kWide][kWide];  // [grey / 256]
  for (int j = 0; j < kWide; ++j)
    for (int i = 0; i < kWide; ++i) smooth[j][i] = binomial(&along[j + 2][i], kWide);

  std::int64_t xx = 0, xy = 0, yy = 0;
  for (int j = 1; j < kWide - 1; ++j)
    for (int i = 1; i < kWide - 1; ++i) {
      const std::int64_t gx = smooth[j][i + 1] - smooth[j][i - 1];
      const std::int64_t gy = smooth[j + 1][i] - smooth[j - 1][i];
      xx += gx * gx;
      xy += gx * gy;
      yy += gy * gy;
    }
  // Their product and sum say what the ratio r is without a root: det / trace^2 = r / (1 + r)^2.
  const auto a = static_cast<float>(xx), b = static_cast<float>(xy), c = static_cast<float>(yy);
  return a * c - b * b < kLeastRatio / ((1 + kLeastRatio) * (1 + kLeastRatio)) * (a + c) * (a + c);
}

}  // namespace pf
