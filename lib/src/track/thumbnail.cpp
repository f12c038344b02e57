#include "track/thumbnail.h"

#include <algorithm>
#include <cmath>

#include "track/tuning.h"

namespace pf {

void make_thumbnail(const Pyramid& pyramid, Thumbnail* thumbnail) {
  int level = 0;
  while (level + 1 < pyramid.levels && pyramid.level[level + 1].width >= Thumbnail::kWidth) ++level;
  const ImageView& image = pyramid.level[level];
  for (int y = 0; y < Thumbnail::kHeight; ++y) {
    for (int x = 0; x < Thumbnail::kWidth; ++x) {
      const int x0 = x * image.width / Thumbnail::kWidth, y0 = y * image.height / Thumbnail::kHeight;
      const int x1 = std::max(x0 + 1, (x + 1) * image.width / Thumbnail::kWidth);
      const int y1 = std::max(y0 + 1, (y + 1) * image.height / Thumbnail::kHeight);
      const int pixels = (x1 - x0) * (y1 - y0);
      int sum = pixels / 2;
      for (int v = y0; v < y1; ++v)
        for (int u = x0; u < x1; ++u) sum += image.at(u, v);
      thumbnail->pixels[y * Thumbnail::kWidth + x] = static_cast<std::uint8_t>(sum / pixels);
    }
  }
}

/// With n pixels:  (n sum ab - sum a sum b) / sqrt((n sum aa - (sum a)^2) (n sum bb - (sum b)^2)), exact in 64-bit integers.
float correlate(const Thumbnail& a, const Thumbnail& b, int dx, int dy) {
  const int x0 = std::max(0, dx), x1 = Thumbnail::kWidth + std::min(0, dx);
  const int y0 = std::max(0, dy), y1 = Thumbnail::kHeight + std::min(0, dy);
  int sa = 0, sb = 0, saa = 0, sbb = 0, sab = 0;  // at most 1200 * 255^2
  for (int y = y0; y < y1; ++y) {
    const std::uint8_t* row_a = a.pixels + y * Thumbnail::kWidth;
    const std::uint8_t* row_b = b.pixels + (y - dy) * Thumbnail::kWidth;
    for (int x = x0; x < x1; ++x) {
      const int pa = row_a[x], pb = row_b[x - dx];
      sa += pa;
      sb += pb;
      saa += pa * pa;
      sbb += pb * pb;
      sab += pa * pb;
    }
  }
  const std::int64_t n = (x1 - x0) * (y1 - y0);
  const std::int64_t vaa = n * saa - std::int64_t{sa} * sa;
  const std::int64_t vbb = n * sbb - std::int64_t{sb} * sb;
  const std::int64_t vab = n * sab - std::int64_t{sa} * sb;
  const std::int64_t flat = n * n * tuning::thumbnail::kMinVariance;
  if (vaa <= flat || vbb <= flat) return 0;
  return static_cast<float>(static_cast<double>(vab) / std::sqrt(static_cast<double>(vaa) * static_cast<double>(vbb)));
}

}  // namespace pf
