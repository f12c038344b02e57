#pragma once

#include <cstdint>

#include "base/scalar.h"
#include "covariance/kernels.h"

/// Which tuned sets this build has. Those of one processor feature are files of their own, compiled with its flags.

#if defined(__x86_64__)
#define PF_HAS_AVX2 1
#define PF_HAS_AVX512 1
#elif defined(__aarch64__)
#define PF_HAS_NEON 1
#elif defined(__arm__) && defined(__ARM_ARCH_PROFILE) && __ARM_ARCH_PROFILE == 'A' && defined(PLANEFOLD_SCALAR_FLOAT)
#define PF_HAS_NEON 1  // ARMv7 has NEON for float only
#endif

namespace pf {

const Kernels& portable_kernels();
const Kernels& avx2_kernels();
const Kernels& avx512_kernels();
const Kernels& neon_kernels();

}  // namespace pf
