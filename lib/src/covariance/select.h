#pragma once

#include <cstdint>

#include "covariance/kernels.h"

namespace pf {

/// The kernel set of a number of pf_kernels_t; 0 picks the fastest that this processor runs. Null where this processor or build
/// cannot run it.
const Kernels* select_kernels(std::uint32_t wanted);

/// The number of a set.
std::uint32_t kernels_id(const Kernels* kernels);

}  // namespace pf
