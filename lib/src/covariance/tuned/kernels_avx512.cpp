// Skylake-X, Zen 4 and later: AVX-512 with F, DQ and VL.
#include <immintrin.h>

#include <cstddef>

#include "covariance/tuned/sets.h"

#define PF_VECTOR_BYTES 64
#define PF_TILE_ROWS 8
#define PF_TILE_VECTORS 3

namespace pf {
namespace {

#define PF_FUNCTION [[maybe_unused]] inline __attribute__((always_inline))
PF_FUNCTION __m512d plus_product(__m512d a, __m512d b, __m512d c) { return _mm512_fmadd_pd(a, b, c); }
PF_FUNCTION __m512d minus_product(__m512d a, __m512d b, __m512d c) { return _mm512_fnmadd_pd(a, b, c); }
PF_FUNCTION __m512 plus_product(__m512 a, __m512 b, __m512 c) { return _mm512_fmadd_ps(a, b, c); }
PF_FUNCTION __m512 minus_product(__m512 a, __m512 b, __m512 c) { return _mm512_fnmadd_ps(a, b, c); }

// Half a register: rows of the triangle are multiples of eight floats.
PF_FUNCTION __m256 plus_product(__m256 a, __m256 b, __m256 c) { return _mm256_fmadd_ps(a, b, c); }
PF_FUNCTION __m256 minus_product(__m256 a, __m256 b, __m256 c) { return _mm256_fnmadd_ps(a, b, c); }

PF_FUNCTION __m512d load_pieces(const double* from, std::ptrdiff_t stride, __m512d) {
  __m512d v = _mm512_castpd128_pd512(_mm_loadu_pd(from));
  v = _mm512_insertf64x2(v, _mm_loadu_pd(from + stride), 1);
  v = _mm512_insertf64x2(v, _mm_loadu_pd(from + 2 * stride), 2);
  return _mm512_insertf64x2(v, _mm_loadu_pd(from + 3 * stride), 3);
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

const Kernels& avx512_kernels() { return kTable; }

}  // namespace pf
