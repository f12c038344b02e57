// AArch64: double and float, 32 registers. ARMv7: float, 16 registers, NEON with fused multiply-add (VFPv4).
// What they cost there: lib/docs/results/arm.md.
#include "covariance/tuned/sets.h"

#if defined(PF_HAS_NEON)

#include <arm_neon.h>

#define PF_VECTOR_BYTES 16
#define PF_TILE_ROWS 4
#if defined(__aarch64__)
#define PF_TILE_VECTORS 5
#else
#define PF_TILE_VECTORS 3
#endif

namespace pf {
namespace {

#define PF_FUNCTION [[maybe_unused]] inline __attribute__((always_inline))
PF_FUNCTION float32x4_t plus_product(float32x4_t a, float32x4_t b, float32x4_t c) { return vfmaq_f32(c, a, b); }
PF_FUNCTION float32x4_t minus_product(float32x4_t a, float32x4_t b, float32x4_t c) { return vfmsq_f32(c, a, b); }
#if defined(__aarch64__)
PF_FUNCTION float64x2_t plus_product(float64x2_t a, float64x2_t b, float64x2_t c) { return vfmaq_f64(c, a, b); }
PF_FUNCTION float64x2_t minus_product(float64x2_t a, float64x2_t b, float64x2_t c) { return vfmsq_f64(c, a, b); }
#endif

PF_FUNCTION double square_root(double x) { return __builtin_sqrt(x); }
PF_FUNCTION float square_root(float x) { return __builtin_sqrtf(x); }

}  // namespace
}  // namespace pf

#include "covariance/tuned/table.h"

namespace pf {

const Kernels& neon_kernels() { return kTable; }

}  // namespace pf

#endif
