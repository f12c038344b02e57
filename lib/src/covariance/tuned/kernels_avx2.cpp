// Haswell, Zen and later: AVX2 and FMA.
#include <immintrin.h>

#include <cstddef>

#include "covariance/tuned/sets.h"

#define PF_VECTOR_BYTES 32
#define PF_TILE_ROWS 4
#define PF_TILE_VECTORS 3

namespace pf {
namespace {

#define PF_FUNCTION [[maybe_unused]] inline __attribute__((always_inline))
PF_FUNCTION __m256d plus_product(__m256d a, __m256d b, __m256d c) { return _mm256_fmadd_pd(a, b, c); }
PF_FUNCTION __m256d minus_product(__m256d a, __m256d b, __m256d c) { return _mm256_fnmadd_pd(a, b, c); }
PF_FUNCTION __m256 plus_product(__m256 a, __m256 b, __m256 c) { return _mm256_fmadd_ps(a, b, c); }
PF_FUNCTION __m256 minus_product(__m256 a, __m256 b, __m256 c) { return _mm256_fnmadd_ps(a, b, c); }

PF_FUNCTION __m256d load_pieces(const double* from, std::ptrdiff_t stride, __m256d) {
  return _mm256_insertf128_pd(_mm256_castpd128_pd256(_mm_loadu_pd(from)), _mm_loadu_pd(from + stride), 1);
}
PF_FUNCTION __m256 load_pieces(const float* from, std::ptrdiff_t stride, __m256) {
  return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(from)), _mm_loadu_ps(from + stride), 1);
}

PF_FUNCTION double square_root(double x) {
  const __m128d v = _mm_set_sd(x);
  return _mm_cvtsd_f64(_mm_sqrt_sd(v, v));
}
PF_FUNCTION float square_root(float x) { return _mm_cvtss_f32(_mm_sqrt_ss(_mm_set_ss(x))); }

}  // namespace
}  // namespace pf

#include "covariance/tuned/table.h"

namespace pf {

const Kernels& avx2_kernels() { return kTable; }

}  // namespace pf
