#pragma once

#include "filter/filter.h"

namespace pf {

/// Place x_K of a feature in a reference camera K, and its covariance there given K, without what is apart. False where it has no place.
bool point_given(const Filter& filter, int camera, int slot, Vec3* x_K, Mat3* covariance_K);

}  // namespace pf
