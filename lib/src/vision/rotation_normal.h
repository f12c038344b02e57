#pragma once

#include <cmath>

#include "vision/rotation_align.h"

namespace pf {

/// Sums over the pixels that both images see, of the products of 1, T, J_x, J_y, J_z and I.
struct RotationAligner::Normal {
  static constexpr int kTerms = 6;
  static constexpr int kRowStep = 2;  // every second row is enough, since the blur makes neighbours say the same
  float at[kTerms][kTerms];           // upper triangle

  /// Of image and template with gain and bias taken out.
  float scatter_image() const { return at[5][5] - at[0][5] * at[0][5] / at[0][0]; }
  float scatter_template() const { return at[1][1] - at[0][1] * at[0][1] / at[0][0]; }
  float scatter_both() const { return at[1][5] - at[0][1] * at[0][5] / at[0][0]; }
  float rms() const {
    const float left = scatter_image() - scatter_both() * scatter_both() / scatter_template();
    return left > 0.0f ? std::sqrt(left / at[0][0]) : 0.0f;
  }
};

}  // namespace pf
