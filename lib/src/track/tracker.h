#pragma once

#include "base/arena.h"
#include "geometry/camera.h"
#include "vision/appearance.h"
#include "vision/corners.h"
#include "vision/image.h"
#include "vision/pyramid.h"

/// From images to pixels: it is told where to look for which feature and how sure that is, and says where it found it.

namespace pf {

/// Where a feature should be in this frame, and how it was seen first.
struct SearchTask {
  const Appearance* appearance = nullptr;
  CameraView first_view;               ///< that the appearance was taken from
  Vec2 predicted = Vec2::Zero();       ///< [px]
  Mat2 innovation = Mat2::Identity();  ///< covariance of (measured - predicted) [px^2]
  Scalar gate = 9;                     ///< chi-square bound of the ellipse
  Vec3 p_W = Vec3::Zero();             ///< the point, about
  Vec3 normal_W = Vec3::Zero();        ///< of the surface there, either sign; zero: not known
  Quat q_WC = Quat::Identity();        ///< camera now
  Vec3 c_W = Vec3::Zero();             ///< its centre
};

struct SearchOutcome {
  bool comparable = false;  ///< this view can be compared with the first one: not finding it means something
  bool found = false;
  Vec2 pixel = Vec2::Zero();
  Mat2 noise = Mat2::Zero();  ///< covariance of the pixel, from how well the template fits the image there [px^2]
  Scalar level_scale = 1;     ///< pixels of level 0 per pixel of the finest level that was used
  float score = 0;            ///< zero-mean normalised correlation
};

class Tracker {
 public:
  static constexpr int kLevels = 4;
  static constexpr Scalar kTypicalSigma = Scalar(0.6);  ///< [px] of a match, before the image has said how good it is

  bool layout(Arena& arena, int width, int height);
  void init(const Camera& camera) { camera_ = camera; }

  /// Takes in a frame. False when there is nothing in it to track by: black, white, blurred out.
  bool begin_frame(const ImageView& image);

  /// Copies what is around a pixel of this frame. False, appearance untouched, when it is too near to the border.
  bool remember(const Vec2& pixel, Appearance* appearance) const;

  SearchOutcome search(const SearchTask& task) const;

  /// Corners of one cell of the image, best first. Returns how many.
  int corners(const Rect& cell, int threshold, Corner* out, int capacity) const;

  const Pyramid& pyramid() const { return pyramid_; }
  ImageView image() const { return pyramid_.level[0]; }

 private:
  bool warp(const SearchTask& task, Mat2* A) const;

  Camera camera_;
  Pyramid pyramid_;
  CornerWorkspace corner_workspace_;
};

}  // namespace pf
