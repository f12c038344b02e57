#include "bundle/start_record.h"

#include <algorithm>

#include "base/elapsed.h"
#include "geometry/so3.h"

namespace pf {

bool StartRecord::layout(Arena& arena) {
  frame_ = arena.take<Frame>(kMaxFrames);
  ray_ = arena.take<Vec3>(kMaxFeatures);
  pixel_ = arena.take<BundlePixel>(kMaxFrames * kMaxFeatures);
  return arena.ok();
}

void StartRecord::init(std::int64_t begin_ns) {
  begin_ns_ = begin_ns;
  frames_ = 0;
  features_ = 0;
  held_ = -1;
}

int StartRecord::add_feature(const Vec3& ray) {
  if (features_ == kMaxFeatures) return -1;
  ray_[features_] = ray;
  return features_++;
}

int StartRecord::add_frame(std::int64_t t_ns, const Quat& q_WC, const Vec3& p_W) {
  if (frames_ == kMaxFrames) drop_every_second();
  frame_[frames_].t_ns = t_ns;
  frame_[frames_].q_WC = q_WC;
  frame_[frames_].p_W = p_W;
  for (int i = 0; i < kMaxFeatures; ++i) pixel_[frames_ * kMaxFeatures + i].seen = false;
  return frames_++;
}

/// Of the frames 2k - 1 and 2k the second stays, or the one that is held.
void StartRecord::drop_every_second() {
  frames_ = 1;
  for (int k = 1; 2 * k <= kMaxFrames; ++k) {
    const bool is_held = held_ == 2 * k - 1 || held_ == 2 * k;
    const int from = held_ == 2 * k - 1 ? held_ : 2 * k;
    if (from >= kMaxFrames) continue;
    frame_[k] = frame_[from];
    std::copy(pixel_ + from * kMaxFeatures, pixel_ + (from + 1) * kMaxFeatures, pixel_ + k * kMaxFeatures);
    if (is_held) held_ = k;
    frames_ = k + 1;
  }
}

void StartRecord::add_pixel(int frame, int feature, const Vec2& pixel) {
  BundlePixel& p = pixel_[frame * kMaxFeatures + feature];
  p.x = static_cast<float>(pixel.x());
  p.y = static_cast<float>(pixel.y());
  p.seen = true;
}

BundleRates StartRecord::rates(int k) const {
  const Frame first = {begin_ns_, Quat::Identity(), Vec3::Zero()};
  const int last = frames_ - 1;
  const auto at = [&](int i) { return i < 0 ? first : frame_[i]; };
  const Frame before = at(std::max(k - 1, -1)), after = at(std::min(k + 1, last));
  const Scalar dt = static_cast<Scalar>(seconds(elapsed_ns(before.t_ns, after.t_ns)));
  if (!(dt > Scalar(0))) return {Vec3::Zero(), Vec3::Zero()};
  return {(after.p_W - before.p_W) / dt, log_so3(before.q_WC.conjugate() * after.q_WC) / dt};
}

}  // namespace pf
