// Vectors of 16 bytes in the compiler's own notation: what every processor with any vectors has, and plain code elsewhere.
#include "covariance/tuned/sets.h"

#define PF_VECTOR_BYTES 16
#if defined(__SSE2__) || defined(__ARM_NEON)
#define PF_TILE_ROWS 4
#else
#define PF_TILE_ROWS 2
#endif
#define PF_TILE_VECTORS 2

namespace pf {
namespace {

template <class V>
inline __attribute__((always_inline)) V plus_product(V a, V b, V c) {
  return c + a * b;
}
template <class V>
inline __attribute__((always_inline)) V minus_product(V a, V b, V c) {
  return c - a * b;
}

[[maybe_unused]] inline double square_root(double x) { return __builtin_sqrt(x); }
[[maybe_unused]] inline float square_root(float x) { return __builtin_sqrtf(x); }

}  // namespace
}  // namespace pf

#include "covariance/tuned/table.h"

namespace pf {

const Kernels& portable_kernels() { return kTable; }

}  // namespace pf
