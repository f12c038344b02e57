#pragma once

#include <cstdint>

#include "base/arena.h"
#include "bundle/bundle.h"

namespace pf {

class Archive;

/// Pixels of up to kMaxFeatures features, all first seen in frame 0, over up to kMaxFrames frames. When full, every
/// second frame is dropped, so that a resting camera does not fill it; but not the one that is held.
class StartRecord {
 public:
  static constexpr int kMaxFrames = 32;
  static constexpr int kMaxFeatures = 64;

  struct Frame {
    std::int64_t t_ns;
    Quat q_WC;  ///< W is frame 0's camera
    Vec3 p_W;
  };

  bool layout(Arena& arena);
  /// begin_ns: time of frame 0.
  void init(std::int64_t begin_ns = 0);

  /// Feature of frame 0, by the ray on which it was first seen; its index, or -1 when there are kMaxFeatures.
  int add_feature(const Vec3& ray);
  void set_ray(int feature, const Vec3& ray) { ray_[feature] = ray; }
  /// Adds a later frame with its estimated pose; add_pixel adds its pixels. Returns its index.
  int add_frame(std::int64_t t_ns, const Quat& q_WC, const Vec3& p_W);
  /// The newest frame stays in the record. One frame is held, the last for which this was called.
  void hold_newest() { held_ = frames_ - 1; }
  void add_pixel(int frame, int feature, const Vec2& pixel);
  /// Velocities of a frame by the poses of those beside it; -1: of frame 0.
  BundleRates rates(int k) const;

  std::int64_t begin_ns() const { return begin_ns_; }
  int frames() const { return frames_; }
  int features() const { return features_; }
  Frame& frame(int k) { return frame_[k]; }
  const Frame& frame(int k) const { return frame_[k]; }
  const Vec3& ray(int i) const { return ray_[i]; }
  const Vec3* rays() const { return ray_; }
  Vec3* rays() { return ray_; }
  const BundlePixel* pixels(int k) const { return pixel_ + k * kMaxFeatures; }  ///< by feature
  bool seen(int k, int i) const { return pixels(k)[i].seen; }
  Vec2 pixel(int k, int i) const { return pixels(k)[i].pixel(); }

  void carry(Archive& archive);  ///< base/archive.h

 private:
  void drop_every_second();

  Frame* frame_ = nullptr;  ///< frame 0 itself is not stored: its pose is the identity
  Vec3* ray_ = nullptr;
  BundlePixel* pixel_ = nullptr;
  std::int64_t begin_ns_ = 0;
  int frames_ = 0;
  int features_ = 0;
  int held_ = -1;  ///< frame that is not dropped; -1: none
};

}  // namespace pf
