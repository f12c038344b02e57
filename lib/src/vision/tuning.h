#pragma once

#include "base/scalar.h"

/// Tuned numbers of vision: what each one means and its unit. tools/sweep-tuning halves and doubles them; what no sweep
/// has measured has no figure here.

namespace pf::tuning {

/// Sub-pixel alignment of a window.
namespace align {
inline constexpr float kSmallStep = 0.01f;    ///< [px]; the next step would be well below what noise leaves
inline constexpr float kMinContrast = 1.0f;   ///< standard deviation of the window [grey levels]
inline constexpr float kMinAspect = 2e-4f;    ///< weaker eigenvalue to both; below, floats see a singular matrix
inline constexpr float kMinGradient = 0.25f;  ///< root mean square in the weaker direction [grey levels/px]
inline constexpr float kMinGain = 0.02f;      ///< of the image against the template
}  // namespace align

/// Patches on planes.
namespace plane_patch {
inline constexpr float kMinGradient = 1.0f;  ///< root mean square in the weaker direction of a patch [grey levels/px]
inline constexpr float kDark = 1.0f;         ///< [grey levels]; what is darker may be cut off
inline constexpr float kBright = 254.0f;     ///< [grey levels]; what is brighter may be cut off
inline constexpr float kOtherLight = 0.8f;   ///< residuals in a new light, of those in the old, that it is taken for
inline constexpr float kMinFitting = 0.33f;  ///< of the samples, those that the residuals' scale is of
inline constexpr float kMaxPerDepth = 1e3f;  ///< inverse depth of a ray in the image, against the patch's middle
}  // namespace plane_patch

/// Masks of templates.
namespace template_mask {
inline constexpr float kWarpError = 0.25f;      ///< [px] of a warp and its interpolation, on the dominant plane
inline constexpr float kMinSigmaPlane = 6.0f;   ///< of residuals on the dominant plane [grey levels], from
inline constexpr float kMaxSigmaPlane = 12.0f;  ///< to
inline constexpr float kMinSigmaOther = 25.0f;  ///< of residuals off it [grey levels], from
inline constexpr float kMaxSigmaOther = 60.0f;  ///< to
inline constexpr int kDark = 1;                 ///< [grey levels]; what is darker may be cut off
inline constexpr int kBright = 254;             ///< [grey levels]; what is brighter may be cut off
}  // namespace template_mask

/// Whether an image has content.
namespace frame_use {
inline constexpr float kMinDeviation = 3.0f;  ///< standard deviation of the image [grey levels]
inline constexpr float kMinGradient = 0.5f;   ///< mean square gradient [squared grey levels]
inline constexpr float kDark = 8.0f;          ///< mean of a black image [grey levels]
inline constexpr float kBright = 247.0f;      ///< mean of a white image [grey levels]
}  // namespace frame_use

/// Dark quadrilaterals.
namespace quad {
inline constexpr int kMinRange = 30;               ///< darkest to lightest part of a usable image [grey levels]
inline constexpr Scalar kMinContrast = 25;         ///< across every side [grey levels]
inline constexpr Scalar kMinArea = Scalar(0.002);  ///< of the image's area
inline constexpr Scalar kSameCorners = 4;  ///< mean distance of the corners of one and the same quadrilateral [px]
inline constexpr int kBorder = 3;          ///< [px] that outlines keep clear of
inline constexpr Scalar kMinSide = 8;      ///< [px]
inline constexpr Scalar kMinSine = Scalar(0.25);     ///< of the angle at a corner
inline constexpr Scalar kMaxBulge = Scalar(0.06);    ///< of a side, in parts of its length
inline constexpr Scalar kMaxAreaGap = Scalar(0.12);  ///< between outline and corners, in parts of the area
}  // namespace quad

}  // namespace pf::tuning
