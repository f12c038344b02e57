#include "track/view_memory.h"

#include <algorithm>

#include "track/image_rotation.h"
#include "track/tuning.h"

namespace pf {

using namespace tuning::view_memory;

void ViewMemory::keep_if_new(const Pyramid& image, const Quat& q_WC, const Vec3& p_W) {
  if (capacity_ == 0) return;
  Thumbnail now;
  make_thumbnail(image, &now);
  ThumbnailMask mask;
  make_thumbnail_mask(image, &mask);
  for (int i = 0; i < count_; ++i)
    if (correlate(now, view_[i].thumbnail, 0, 0, mask) > kKnownView) return;
  view_[next_] = {now, q_WC, p_W};
  count_ = std::min(count_ + 1, capacity_);
  next_ = (next_ + 1) % capacity_;
}

Recognition ViewMemory::recognise(const Pyramid& image, const Camera& camera) const {
  Recognition best;
  if (count_ == 0) return best;
  Thumbnail now;
  make_thumbnail(image, &now);
  ThumbnailMask mask;
  make_thumbnail_mask(image, &mask);
  int best_view = -1, best_dx = 0, best_dy = 0;
  const auto compare = [&](int i, int dx, int dy) {
    const float score = correlate(now, view_[i].thumbnail, dx, dy, mask);
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
  best.p_W = view.p_W;
  Quat turn;
  if (!find_rotation(camera, view.thumbnail, now, mask, &turn))
    turn = rotation_of_shift(camera, Vec2(static_cast<Scalar>(best_dx), static_cast<Scalar>(best_dy)));
  best.q_WC = view.q_WC * turn;
  return best;
}

}  // namespace pf
