#pragma once

#include "base/arena.h"
#include "base/eigen.h"
#include "vision/image.h"

namespace pf {

/// Pinhole of the level that is aligned, lens distortion left out [px of that level].
struct CoarseCamera {
  float fx = 0, fy = 0, cx = 0, cy = 0;
};

struct RotationEstimate {
  bool valid = false;
  int iterations = 0;
  Vec3 rotation = Vec3::Zero();  // ray in the current camera = Exp(rotation) * ray in the previous one [rad]
  float before = 0;              // RMS difference of the two images, gain and bias aside, with no rotation [grey]
  float after = 0;               // and with the estimate, over what both see
  float zncc = 0;                // of the two images with the estimate, over what both see
  float overlap = 0;             // share of the previous image that is still in view
};

/// How far the camera has turned from one frame to the next, from two small blurred images alone: three parameters, and
/// gain and bias between the images,
///
///   min over w, gain, bias of  Σ (I(π(Exp(w) π⁻¹(x))) - gain I_prev(x) - bias)²
///
/// by Gauss-Newton with the gradients of the previous image, R <- R Exp(-d). Any level of a pyramid is welcome; it is
/// halved until it is at most kMaxWidth wide (so that a hand's quick turn is a few pixels) and blurred. Translation is
/// taken for rotation: the answer is where to look, no measurement. The idea of a small blurry image is that of PTAM
/// (Klein and Murray 2008).
class RotationAligner {
 public:
  /// For images of this size. Takes about 24 bytes per pixel of the small image.
  bool layout(Arena& arena, int width, int height);

  /// Forget the previous frame.
  void reset() { has_previous_ = false; }

  /// Estimates from the last image given to this one, which is then kept. `guess` is where to start from: zero, or the
  /// motion model's prediction. Not valid: no previous image, no structure, less than kLeastOverlap in common, images
  /// that do not go together (zncc below kLeastZncc), or no improvement.
  /// Costs about as much as an iteration's number of passes over the small image plus five.
  RotationEstimate update(const ImageView& coarse, const CoarseCamera& camera, const Vec3& guess);

  static constexpr int kMaxWidth = 64;
  static constexpr int kMaxIterations = 10;
  static constexpr float kLeastOverlap = 0.35f;
  static constexpr float kLeastZncc = 0.6f;

 private:
  struct Normal;
  void shrink(const ImageView& coarse);
  void gradients();
  Normal evaluate(const float (&R)[9]) const;

  std::uint8_t* half_[2] = {};
  float* previous_ = nullptr;
  float* current_ = nullptr;
  float* jacobian_[3] = {};
  CoarseCamera camera_;  // of the small image
  int input_width_ = 0;
  int input_height_ = 0;
  int halvings_ = 0;
  int width_ = 0;
  int height_ = 0;
  bool has_previous_ = false;
};

}  // namespace pf
