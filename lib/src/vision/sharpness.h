#pragma once

#include "vision/pyramid.h"

namespace pf {

/// How sharp an image is, against itself at a quarter of the resolution. Smear along u takes gradients along u from the fine level, and
/// leaves those of the coarse one:
///
///   T_l = mean of g gᵀ at level l,   *log_sharpness = ln of the least of uᵀ T_1 u / uᵀ T_3 u over all directions u
///
/// It does not depend on contrast or brightness; it does on what is seen, and on noise, so that only images of one film compare. What a
/// mask hides counts too. False where the image has no such levels, or no gradients in some direction. About one pass over level 1.
bool measure_sharpness(const Pyramid& pyramid, Scalar* log_sharpness);

}  // namespace pf
