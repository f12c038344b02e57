#pragma once

#include "base/eigen.h"
#include "vision/image.h"
#include "vision/patch.h"

namespace pf {

/// A template made ready for alignment: its grey levels about their mean, and its gradients with what a change of gain or
/// bias could explain taken out, so that these need not be estimated beside the shift.
struct AlignTemplate {
  static constexpr int kRow = (kAlignSize + 3) / 4 * 4;  // rows are filled up with zeros

  alignas(16) float grey[kAlignSize * kRow];
  alignas(16) float gx[kAlignSize * kRow];
  alignas(16) float gy[kAlignSize * kRow];
  float energy = 0;                 // Σ grey²
  float hxx = 0, hxy = 0, hyy = 0;  // Σ g gᵀ
  float weakest = 0;                // its smaller eigenvalue
};

/// From kWarpSize * kWarpSize grey levels of warp_template. False: no structure in one direction or in any.
bool make_align_template(const float* warped, AlignTemplate* out);

struct AlignResult {
  bool converged = false;
  int iterations = 0;
  Vec2 position = Vec2::Zero();     // px of the level
  float zncc = 0;                   // of window and template there, -1 .. 1
  float rms = 0;                    // of the image less gain times template less bias, before interpolation [grey]
  float gain = 0;                   // grey of the image per grey of the template
  float hxx = 0, hxy = 0, hyy = 0;  // normal matrix H [grey²/px²], less what noise adds to it; positive definite

  /// Of the position, as far as this window's noise goes: rms² H⁻¹ [px²]. Neither a wrong warp nor the bias of bilinear
  /// interpolation (up to some 0.03 px on detail of a few pixels) is in it.
  Mat2 covariance() const {
    const float scale = rms * rms / (hxx * hyy - hxy * hxy);
    Mat2 out;
    out << static_cast<Scalar>(scale * hyy), static_cast<Scalar>(-scale * hxy), static_cast<Scalar>(-scale * hxy),
        static_cast<Scalar>(scale * hxx);
    return out;
  }
};

constexpr int kAlignMaxIterations = 6;
constexpr float kAlignReach = 2.5f;  // px on each axis

/// Sub-pixel place of a template: inverse-compositional Gauss-Newton of
///
///   min over d, gain, bias of  Σ (I(x + d) - gain T(x) - bias)²,   I bilinear, kAlignSize x kAlignSize pixels
///
/// image   level to search in; start in its px, usually what search() found
/// Not converged: the window leaves the image, the place moves further than kAlignReach from the start, the steps do not
/// get small, or template and image do not go together (gain not positive).
/// Costs about as much as 4 evaluations of 121 pixels.
/// src: Baker and Matthews 2004 (inverse composition); gain and bias projected out of the gradients.
AlignResult align(const ImageView& image, const AlignTemplate& pattern, const Vec2& start);

}  // namespace pf
