#pragma once

#include "geometry/camera.h"
#include "vision/plane_patch.h"
#include "vision/pyramid.h"

namespace pf {

/// Looks for a patch where the aligner would not reach it: its coarse pixels, warped as it is expected, are correlated with the image at
/// every place inside of the ellipse about its expected middle.
class PatchSearch {
 public:
  bool layout(Arena& arena);

  /// H_CK        rays of the reference at depth 1 to rays of this image, where the patch is expected
  /// innovation  covariance of its middle [px^2]; gate: chi-square bound of the ellipse
  /// *shift      from where it is expected to where it matches the image [px]; valid where true is returned
  bool find(const Pyramid& image, const Camera& camera, const PlanePatch& patch, const Mat3& H_CK,
            const Mat2& innovation, Scalar gate, Vec2* shift);

 private:
  struct Sample {
    std::int16_t dx, dy;  ///< from the patch's middle [px of the level]
    std::int16_t grey;    ///< about the mean
  };

  bool load(const ImageView& image, int level, const Camera& camera, const PlanePatch& patch, const Mat3& H_CK);
  float correlation(const ImageView& image, int x, int y) const;
  float best_near(const ImageView& image, const Mat2& ellipse, int* x, int* y) const;

  Sample* sample_ = nullptr;  ///< kMaxSamples
  int count_ = 0;
  float squares_ = 0;                                ///< of the samples' greys
  int left_ = 0, right_ = 0, top_ = 0, bottom_ = 0;  ///< of dx and dy, the extremes
  Vec2 middle_;                                      ///< expected [px of the level]
};

}  // namespace pf
