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

void make_thumbnail_mask(const Pyramid& pyramid, ThumbnailMask* mask) {
  const ImageMask* of_image = in_use(pyramid.mask);
  mask->has_masked = of_image != nullptr;
  if (of_image == nullptr) return;
  const int width = pyramid.level[0].width, height = pyramid.level[0].height;
  for (int y = 0; y < Thumbnail::kHeight; ++y)
    for (int x = 0; x < Thumbnail::kWidth; ++x) {
      const int left = x * width / Thumbnail::kWidth, top = y * height / Thumbnail::kHeight;
      const Rect covered{left, top, (x + 1) * width / Thumbnail::kWidth + 1 - left,
                         (y + 1) * height / Thumbnail::kHeight + 1 - top};
      mask->masked[y * Thumbnail::kWidth + x] = !of_image->is_clear(covered);
    }
}

namespace {

/// Sums over the pixels that both thumbnails show: at most 1200 * 255^2.
struct PairSums {
  int n = 0, a = 0, b = 0, aa = 0, bb = 0, ab = 0;

  void add(int pa, int pb) {
    a += pa;
    b += pb;
    aa += pa * pa;
    bb += pb * pb;
    ab += pa * pb;
  }

  /// With n pixels:  (n sum ab - sum a sum b) / sqrt((n sum aa - (sum a)^2) (n sum bb - (sum b)^2)), exact in 64-bit integers.
  float correlation() const {
    const std::int64_t count = n;
    const std::int64_t vaa = count * aa - std::int64_t{a} * a;
    const std::int64_t vbb = count * bb - std::int64_t{b} * b;
    const std::int64_t vab = count * ab - std::int64_t{a} * b;
    const std::int64_t flat = count * count * tuning::thumbnail::kMinVariance;
    if (vaa <= flat || vbb <= flat) return 0;
    return static_cast<float>(static_cast<double>(vab) /
                              std::sqrt(static_cast<double>(vaa) * static_cast<double>(vbb)));
  }
};

}  // namespace

float correlate(const Thumbnail& a, const Thumbnail& b, int dx, int dy) {
  const int x0 = std::max(0, dx), x1 = Thumbnail::kWidth + std::min(0, dx);
  const int y0 = std::max(0, dy), y1 = Thumbnail::kHeight + std::min(0, dy);
  PairSums sums;
  for (int y = y0; y < y1; ++y) {
    const std::uint8_t* row_a = a.pixels + y * Thumbnail::kWidth;
    const std::uint8_t* row_b = b.pixels + (y - dy) * Thumbnail::kWidth;
    for (int x = x0; x < x1; ++x) sums.add(row_a[x], row_b[x - dx]);
  }
  sums.n = (x1 - x0) * (y1 - y0);
  return sums.correlation();
}

float correlate(const Thumbnail& a, const Thumbnail& b, int dx, int dy, const ThumbnailMask& mask) {
  if (!mask.has_masked) return correlate(a, b, dx, dy);
  const int x0 = std::max(0, dx), x1 = Thumbnail::kWidth + std::min(0, dx);
  const int y0 = std::max(0, dy), y1 = Thumbnail::kHeight + std::min(0, dy);
  PairSums sums;
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x) {
      if (mask.at(x, y) || mask.at(x - dx, y - dy)) continue;
      sums.add(a.at(x, y), b.at(x - dx, y - dy));
      ++sums.n;
    }
  return sums.n < tuning::image_rotation::kMinOverlap ? 0.0f : sums.correlation();
}

}  // namespace pf
