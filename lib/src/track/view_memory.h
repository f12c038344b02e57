#pragma once

#include <cstdint>

#include "base/arena.h"
#include "geometry/camera.h"
#include "vision/pyramid.h"

/// Thumbnails of tracked frames with their poses, by which a place is recognised roughly (Klein and Murray 2008). See lib/docs/states.md.

namespace pf {

struct Thumbnail {
  static constexpr int kWidth = 40, kHeight = 30;
  std::uint8_t pixels[kWidth * kHeight];
};

/// Zero-mean normalised correlation of a(x, y) with b(x - dx, y - dy) over what both show, -1 .. 1; 0 where one of them is flat.
/// |dx|, |dy| less than half of the thumbnail.
float correlate(const Thumbnail& a, const Thumbnail& b, int dx, int dy);

/// A kept view that looks like the current image.
struct Recognition {
  float score = 0;  ///< correlation, -1 .. 1
  Quat q_WC = Quat::Identity();
  Vec3 p_W = Vec3::Zero();
};

class ViewMemory {
 public:
  bool layout(Arena& arena, int capacity) {
    view_ = arena.take<View>(static_cast<std::size_t>(capacity));
    capacity_ = capacity;
    return arena.ok();
  }
  void init() { count_ = next_ = 0; }
  int count() const { return count_; }

  /// Makes the thumbnail of the current frame.
  void set_image(const Pyramid& pyramid);
  /// Keeps the current thumbnail with its pose if it looks like none that is kept. A full memory replaces its oldest.
  void keep_if_new(const Quat& q_WC, const Vec3& p_W);
  /// The kept view that correlates best with the current thumbnail, rotated by the shift of the image. Score 0 without any.
  Recognition recognise(const Camera& camera) const;

 private:
  struct View {
    Thumbnail thumbnail;
    Quat q_WC;
    Vec3 p_W;
  };

  Thumbnail now_;
  View* view_ = nullptr;
  int capacity_ = 0;
  int count_ = 0, next_ = 0;
};

}  // namespace pf
