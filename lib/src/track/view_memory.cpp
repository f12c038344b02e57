#include "track/view_memory.h"

#include <algorithm>
#include <cmath>

#include "track/tuning.h"

namespace pf {

using namespace tuning::view_memory;

namespace {

/// Rotation that takes unit vector a to unit vector b by the shortest way.
Quat shortest_rotation(const Vec3& a, const Vec3& b) {
  const Vec3 axis = a.cross(b);
  Quat q(Scalar(1) + a.dot(b), axis.x(), axis.y(), axis.z());
  q.normalize();
  return q;
}

}  // namespace

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
  const std::int64_t flat = n * n * kMinVariance;
  if (vaa <= flat || vbb <= flat) return 0;
  return static_cast<float>(static_cast<double>(vab) / std::sqrt(static_cast<double>(vaa) * static_cast<double>(vbb)));
}

void ViewMemory::set_image(const Pyramid& pyramid) {
  if (capacity_ == 0) return;
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
      now_.pixels[y * Thumbnail::kWidth + x] = static_cast<std::uint8_t>(sum / pixels);
    }
  }
}

void ViewMemory::keep_if_new(const Quat& q_WC, const Vec3& p_W) {
  if (capacity_ == 0) return;
  for (int i = 0; i < count_; ++i)
    if (correlate(now_, view_[i].thumbnail, 0, 0) > kKnownView) return;
  view_[next_] = {now_, q_WC, p_W};
  count_ = std::min(count_ + 1, capacity_);
  next_ = (next_ + 1) % capacity_;
}

Recognition ViewMemory::recognise(const Camera& camera) const {
  Recognition best;
  int best_view = -1, best_dx = 0, best_dy = 0;
  const auto compare = [&](int i, int dx, int dy) {
    const float score = correlate(now_, view_[i].thumbnail, dx, dy);
    if (score <= best.score) return;
    best.score = score;
    best_view = i;
    best_dx = dx;
    best_dy = dy;
  };
  for (int i = 0; i < count_; ++i)
    for (int dy = -kMaxShift; dy <= kMaxShift; dy += 2)
      for (int dx = -kMaxShift; dx <= kMaxShift; dx += 2) compare(i, dx, dy);
  if (best_view < 0) return best;
  const int dx0 = best_dx, dy0 = best_dy;
  for (int dy = dy0 - 1; dy <= dy0 + 1; ++dy)
    for (int dx = dx0 - 1; dx <= dx0 + 1; ++dx) compare(best_view, dx, dy);
  const View& view = view_[best_view];
  best.q_WC = view.q_WC;
  best.p_W = view.p_W;
  // What was at the centre minus half of the shift is now at the centre plus half of it.
  const Vec2 centre(static_cast<Scalar>(camera.width) / 2, static_cast<Scalar>(camera.height) / 2);
  const Vec2 shift(static_cast<Scalar>(best_dx * camera.width) / Thumbnail::kWidth,
                   static_cast<Scalar>(best_dy * camera.height) / Thumbnail::kHeight);
  Vec3 then_C, now_C;
  if (unproject(camera, centre - shift / 2, &then_C) && unproject(camera, centre + shift / 2, &now_C))
    best.q_WC = view.q_WC * shortest_rotation(now_C, then_C);
  return best;
}

}  // namespace pf
