#include "vision/blur.h"

#include <cmath>

#include "vision/simd.h"
#include "vision/tuning.h"

namespace pf {

namespace {

using namespace tuning::frame_use;

/// Sums over one row: of the pixels, their squares, and the squared differences. `below` may be the row itself.
struct RowSums {
  std::uint32_t sum, square, gradient;
};

RowSums sum_row(const std::uint8_t* row, const std::uint8_t* below, int width) {
  std::uint32_t sum = row[width - 1];
  std::uint32_t square = static_cast<std::uint32_t>(row[width - 1] * row[width - 1]);
  std::uint32_t gradient = 0;
  for (int x = 0; x < width - 1; ++x) {
    const std::int16_t value = row[x];
    const std::int16_t dx = static_cast<std::int16_t>(row[x + 1] - row[x]);
    const std::int16_t dy = static_cast<std::int16_t>(below[x] - row[x]);
    sum += static_cast<std::uint32_t>(value);
    square += static_cast<std::uint32_t>(value * value);
    gradient += static_cast<std::uint32_t>(dx * dx + dy * dy);
  }
  return RowSums{sum, square, gradient};
}

}  // namespace

FrameStatistics frame_statistics(const ImageView& image) {
  FrameStatistics out;
  if (image.width < 2 || image.height < 2) return out;
  std::uint64_t total = 0;
  std::uint64_t square = 0;
  std::uint64_t gradient = 0;
  for (int y = 0; y < image.height; ++y) {
    const bool last = y == image.height - 1;
    const RowSums s = sum_row(image.row(y), image.row(last ? y : y + 1), image.width);
    total += s.sum;
    square += s.square;
    gradient += last ? 0 : s.gradient;
  }
  // The variance is formed in whole numbers, where nothing cancels: below 2^24 pixels both products fit 64 bits.
  const std::uint64_t pixels = static_cast<std::uint64_t>(image.width) * static_cast<std::uint64_t>(image.height);
  const std::uint64_t scatter = pixels * square - total * total;
  const float n = static_cast<float>(pixels);
  out.mean = static_cast<float>(total) / n;
  out.deviation = std::sqrt(static_cast<float>(scatter)) / n;
  out.gradient_energy =
      static_cast<float>(gradient) / (static_cast<float>(image.width - 1) * static_cast<float>(image.height - 1));
  return out;
}

FrameStatistics frame_statistics(const ImageView& image, int level, const ImageMask& mask) {
  FrameStatistics out;
  std::uint64_t total = 0, square = 0, gradient = 0, pixels = 0;
  const int side = 2 << level;  // of a pixel with its lower right neighbours, in level 0
  for (int y = 0; y + 1 < image.height; ++y)
    for (int x = 0; x + 1 < image.width; ++x) {
      if (!mask.is_clear(Rect{x << level, y << level, side, side})) continue;
      const int value = image.at(x, y), dx = image.at(x + 1, y) - value, dy = image.at(x, y + 1) - value;
      ++pixels;
      total += static_cast<std::uint64_t>(value);
      square += static_cast<std::uint64_t>(value * value);
      gradient += static_cast<std::uint64_t>(dx * dx + dy * dy);
    }
  if (pixels == 0) return out;
  const float n = static_cast<float>(pixels);
  out.mean = static_cast<float>(total) / n;
  out.deviation = std::sqrt(static_cast<float>(pixels * square - total * total)) / n;
  out.gradient_energy = static_cast<float>(gradient) / n;
  return out;
}

FrameUse judge_frame(const FrameStatistics& statistics) {
  if (statistics.deviation >= kMinDeviation && statistics.gradient_energy >= kMinGradient) {
    return FrameUse::kUsable;
  }
  if (statistics.mean < kDark) return FrameUse::kDark;
  if (statistics.mean > kBright) return FrameUse::kBright;
  return FrameUse::kFlat;
}

}  // namespace pf
