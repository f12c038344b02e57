#pragma once

#include <cstdint>

#include "vision/patch.h"
#include "vision/planar_template.h"

/// Which pixels of a template belong to its dominant plane (lib/docs/theory/templates.md). What is learnt of a pixel, in a byte:
///
///   0: there is no image   255: on the plane, whatever it shows (whole templates)   else its log odds, ln(p / (1 - p)) = (byte - 212) / 10

namespace pf {

constexpr std::uint8_t kMaskLeast = 1, kMaskUnknown = 212, kMaskMost = 251, kMaskFull = 255;

/// Probability of belonging to the plane, in 1/255: 0 where there is no image, and nowhere else.
std::uint8_t mask_probability(std::uint8_t odds);

/// One step of the discrete Bayes filter.
///
///   p' = p N(r; 0, sigma_D) / (p N(r; 0, sigma_D) + (1 - p) N(r; 0, sigma_B)),   log odds kept in -21 .. 3.9
///
/// A pixel on the plane (.98) leaves it by one frame; one that has been off it for long comes back by ten or more in a row, since
/// the background resembles the template in some frames.   sigma_D < sigma_B
/// src  Masoud 2015 (7)-(8), which has no bounds
std::uint8_t updated_odds(std::uint8_t odds, float residual, float sigma_plane, float sigma_other);

/// Evidence of one frame for one pixel.
struct MaskEvidence {
  float residual = 0;  ///< template less image, its shift and light taken out [grey levels of the template]
  float slack = 0;     ///< what the uncertainty of the warp makes of the gradient there [grey levels]
  bool valid = false;  ///< in the image, and saturated in neither
};

/// Log odds after a frame. Unchanged where the pixel is not valid, and where the slack explains a residual that would be evidence against
/// the plane.
std::uint8_t learn_pixel(std::uint8_t odds, const MaskEvidence& evidence, float sigma_plane, float sigma_other);

/// Sum of the probabilities [px].
float mask_area(const std::uint8_t* mask, int count);

/// Begins a template on pixels that were remembered: an unknown mask (or a full one), zero where there is no image, and how large residuals
/// will be on the plane and off it.
///
/// noise  standard deviation of the image's own noise [grey levels]
///
///   sigma_D^2 = 2 noise^2 + (warp error)^2 g^2,   sigma_B^2 = 2 var,   g and var: gradient and variance of the template's pixels
void begin_template(const SourcePatch& patch, const Vec2& pixel, int side, bool full, float noise, PlanarTemplate* out,
                    std::uint8_t* mask);

/// Standard deviation of an image's noise [grey levels], from what neighbours do not explain: the quarter of its pixels that have least.
/// Detail in all of the image adds to it.
/// src  Immerkaer 1996, with a quantile in place of the mean
float image_noise(const ImageView& image);

}  // namespace pf
