#include "track/view_memory.h"

#include <algorithm>
#include <cmath>

namespace pf {
namespace {

constexpr int kShift = 8;             // [px] of the small picture to each side
constexpr float kLooksAlike = 0.80f;  // correlation above which a view is known already

/// Correlation of b shifted by (dx, dy): a(x, y) with b(x - dx, y - dy), over what both show.
float correlate(const Thumbnail& a, const Thumbnail& b, int dx, int dy) {
  const int x0 = std::max(0, dx), x1 = Thumbnail::kWidth + std::min(0, dx);
  const int y0 = std::max(0, dy), y1 = Thumbnail::kHeight + std::min(0, dy);
  float sa = 0, sb = 0, saa = 0, sbb = 0, sab = 0;
  for (int y = y0; y < y1; ++y) {
    const float* pa = a.pixels + y * Thumbnail::kWidth;
    const float* pb = b.pixels + (y - dy) * Thumbnail::kWidth - dx;
    for (int x = x0; x < x1; ++x) {
      sa += pa[x];
      sb += pb[x];
      saa += pa[x] * pa[x];
      sbb += pb[x] * pb[x];
      sab += pa[x] * pb[x];
    }
  }
  const float n = static_cast<float>((x1 - x0) * (y1 - y0));
  const float va = saa - sa * sa / n, vb = sbb - sb * sb / n;
  return va > 1 && vb > 1 ? (sab - sa * sb / n) / std::sqrt(va * vb) : 0;
}

/// Rotation that takes unit vector a to unit vector b by the shortest way.
Quat between(const Vec3& a, const Vec3& b) {
  const Vec3 axis = a.cross(b);
  Quat q(Scalar(1) + a.dot(b), axis.x(), axis.y(), axis.z());
  q.normalize();
  return q;
}

}  // namespace

void ViewMemory::look(const Pyramid& pyramid) {
  int level = 0;
  while (level + 1 < pyramid.levels && pyramid.level[level + 1].width >= Thumbnail::kWidth) ++level;
  const ImageView& image = pyramid.level[level];
  for (int y = 0; y < Thumbnail::kHeight; ++y)
    for (int x = 0; x < Thumbnail::kWidth; ++x) {
      const int x0 = x * image.width / Thumbnail::kWidth, y0 = y * image.height / Thumbnail::kHeight;
      const int x1 = std::max(x0 + 1, (x + 1) * image.width / Thumbnail::kWidth);
      const int y1 = std::max(y0 + 1, (y + 1) * image.height / Thumbnail::kHeight);
      int sum = 0;
      for (int v = y0; v < y1; ++v)
        for (int u = x0; u < x1; ++u) sum += image.at(u, v);
      now_.pixels[y * Thumbnail::kWidth + x] = static_cast<float>(sum) / static_cast<float>((x1 - x0) * (y1 - y0));
    }
}

void ViewMemory::keep_if_new(const Quat& q_WC, const Vec3& p_W) {
  for (int i = 0; i < count_; ++i)
    if (correlate(now_, view_[i].picture, 0, 0) > kLooksAlike) return;
  view_[next_] = {now_, q_WC, p_W};
  count_ = std::min(count_ + 1, kViews);
  next_ = (next_ + 1) % kViews;
}

Recognition ViewMemory::recognise(const Camera& camera) const {
  Recognition best;
  int best_view = -1, best_dx = 0, best_dy = 0;
  const auto attempt = [&](int i, int dx, int dy) {
    const float score = correlate(now_, view_[i].picture, dx, dy);
    if (score <= best.score) return;
    best.score = score;
    best_view = i;
    best_dx = dx;
    best_dy = dy;
  };
  for (int i = 0; i < count_; ++i)
    for (int dy = -kShift; dy <= kShift; dy += 2)
      for (int dx = -kShift; dx <= kShift; dx += 2) attempt(i, dx, dy);
  if (best_view < 0) return best;
  const int dx0 = best_dx, dy0 = best_dy;
  for (int dy = dy0 - 1; dy <= dy0 + 1; ++dy)
    for (int dx = dx0 - 1; dx <= dx0 + 1; ++dx) attempt(best_view, dx, dy);
  const View& view = view_[best_view];
  best.q_WC = view.q_WC;
  best.p_W = view.p_W;
  const Vec2 centre(static_cast<Scalar>(camera.width) / 2, static_cast<Scalar>(camera.height) / 2);
  const Vec2 shift(static_cast<Scalar>(best_dx * camera.width) / Thumbnail::kWidth,
                   static_cast<Scalar>(best_dy * camera.height) / Thumbnail::kHeight);
  Vec3 then_C, now_C;
  if (unproject(camera, centre - shift / 2, &then_C) && unproject(camera, centre + shift / 2, &now_C))
    best.q_WC = view.q_WC * between(now_C, then_C);
  return best;
}

}  // namespace pf
