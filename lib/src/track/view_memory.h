#pragma once

#include <cstdint>

#include "base/arena.h"
#include "geometry/camera.h"
#include "vision/pyramid.h"

/// Small pictures of where the camera has been, by which a place is recognised roughly (Klein and Murray 2008).

namespace pf {

struct Thumbnail {
  static constexpr int kWidth = 40, kHeight = 30;
  float pixels[kWidth * kHeight];
};

/// A place that looks like the current picture.
struct Recognition {
  float score = 0;  ///< zero-mean normalised correlation, -1 .. 1
  Quat q_WC = Quat::Identity();
  Vec3 p_W = Vec3::Zero();
};

class ViewMemory {
 public:
  static constexpr int kViews = 24;

  bool layout(Arena& arena) {
    view_ = arena.take<View>(kViews);
    return arena.ok();
  }
  void init() { count_ = next_ = 0; }

  /// The picture of the current frame.
  void look(const Pyramid& pyramid);
  /// Keeps it where it looks like none that is kept; of a full memory the oldest goes.
  void keep_if_new(const Quat& q_WC, const Vec3& p_W);
  /// The kept view that looks most like it, turned by how far the picture is shifted.
  Recognition recognise(const Camera& camera) const;

 private:
  struct View {
    Thumbnail picture;
    Quat q_WC;
    Vec3 p_W;
  };

  Thumbnail now_;
  View* view_ = nullptr;
  int count_ = 0, next_ = 0;
};

}  // namespace pf
