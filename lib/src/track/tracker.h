#pragma once

#include "base/arena.h"
#include "geometry/camera.h"
#include "vision/appearance.h"
#include "vision/corners.h"
#include "vision/image.h"
#include "vision/planar_template.h"
#include "vision/pyramid.h"

/// Finds features in images, given where each is expected and with which covariance. Knows no filter and keeps no features.

namespace pf {

/// Prediction of a feature in this frame, and its first view.
struct SearchTask {
  const Appearance* appearance = nullptr;
  CameraView first_view;               ///< that the appearance was taken from
  Vec2 predicted = Vec2::Zero();       ///< [px]
  Mat2 innovation = Mat2::Identity();  ///< covariance of (measured - predicted) [px^2]
  Scalar gate = 9;                     ///< chi-square bound of the ellipse
  Vec3 p_W = Vec3::Zero();             ///< estimate of the point
  Vec3 normal_W = Vec3::Zero();        ///< of the surface, either sign; zero: not known
  Quat q_WC = Quat::Identity();        ///< current camera
  Vec3 c_W = Vec3::Zero();             ///< its centre
  // With masks only: the template, null where it cannot be used.
  const PlanarTemplate* shape = nullptr;
  const std::uint8_t* mask = nullptr;
};

struct SearchOutcome {
  bool comparable =
      false;  ///< this view can be compared with the first one, so that not finding it counts as a failure
  bool found = false;
  Vec2 pixel = Vec2::Zero();
  Mat2 noise = Mat2::Zero();  ///< covariance of the pixel, from how well the template fits the image there [px^2]
  Scalar level_scale = 1;     ///< pixels of level 0 per pixel of the finest level that was used
  float score = 0;            ///< zero-mean normalised correlation
};

class Tracker {
 public:
  static constexpr int kLevels = 4;

  bool layout(Arena& arena, int width, int height);
  /// mask: what is not the scene; null: all is. It is read in every frame.
  void init(const Camera& camera, const ImageMask* mask = nullptr) {
    camera_ = camera;
    pyramid_.mask = mask;
  }

  /// Builds the pyramid of an image. False if it shows nothing to track: black, white or blurred.
  bool begin_frame(const ImageView& image);

  /// Copies the pixels around a pixel of this image. False, appearance untouched, if the pixel is too near to the border.
  bool remember(const Vec2& pixel, Appearance* appearance) const;

  SearchOutcome search(const SearchTask& task) const;
  /// Whether a pixel is far enough from what is masked for a template. level_scale: pixels for each of the template's.
  bool is_in_scene(const Vec2& pixel, Scalar level_scale = 1) const;
  /// Whether this view of a feature can be compared with the first one. Reads neither innovation nor gate of the task.
  bool is_comparable(const SearchTask& task) const;

  /// Corners of one cell of the image, best first. Returns how many.
  int corners(const Rect& cell, int threshold, Corner* out, int capacity) const;

  /// Source pixels per current pixel at a task's feature. False where either camera does not see it.
  bool warp(const SearchTask& task, Mat2* A) const;

  const Pyramid& pyramid() const { return pyramid_; }
  ImageView image() const { return pyramid_.level[0]; }

 private:
  bool choose_level(const SearchTask& task, Mat2* A, int* finest) const;

  Camera camera_;
  Pyramid pyramid_;
  CornerWorkspace corner_workspace_;
};

}  // namespace pf
