#pragma once

#include "base/arena.h"
#include "geometry/camera.h"
#include "geometry/similarity.h"
#include "track/thumbnail.h"

/// Thumbnails of tracked frames with their poses, by which a place is recognised roughly (Klein and Murray 2008).
/// See lib/docs/theory/states.md.

namespace pf {

class Archive;

/// A kept view that is like the current image.
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
  /// All of W is moved.
  void move(const Similarity& T) {
    move_each([&](const Quat&, const Vec3&) { return T; });
  }

  /// Each view is moved by a similarity of its own: correction(q_WC, p_W).
  template <typename F>
  void move_each(F&& correction) {
    for (int i = 0; i < count_; ++i) {
      const Similarity T = correction(view_[i].q_WC, view_[i].p_W);
      view_[i].q_WC = (T.q * view_[i].q_WC).normalized();
      view_[i].p_W = T.of(view_[i].p_W);
    }
  }

  /// Keeps the thumbnail of an image with its pose if no kept one is like it. A full memory replaces its oldest.
  void keep_if_new(const Pyramid& image, const Quat& q_WC, const Vec3& p_W);
  /// The kept view that correlates best with an image, turned as the image is against it. Score 0 without any.
  Recognition recognise(const Pyramid& image, const Camera& camera) const;

  void carry(Archive& archive);  ///< base/archive.h

 private:
  struct View {
    Thumbnail thumbnail;
    Quat q_WC;
    Vec3 p_W;
  };

  View* view_ = nullptr;
  int capacity_ = 0;
  int count_ = 0, next_ = 0;
};

}  // namespace pf
