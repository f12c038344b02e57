#include "limits.h"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <vector>

#include "base/scalar.h"

namespace bench {
namespace {

using pf::Scalar;
using Clock = std::chrono::steady_clock;

double us_since(Clock::time_point begin) {
  return std::chrono::duration<double, std::micro>(Clock::now() - begin).count();
}

constexpr int kChains = 12;
constexpr int kLoops = 20000;

template <int kBytes>
struct Wide {
  typedef Scalar Type __attribute__((vector_size(kBytes)));
};

/// Independent chains of c = c * a + b; contraction is on for this file. `kBytes` wide vectors.
template <int kBytes>
inline __attribute__((always_inline)) Scalar chains() {
  using Vector = typename Wide<kBytes>::Type;
  Vector c[kChains];
  for (int i = 0; i < kChains; ++i) c[i] = Scalar(i) - Vector{};
  Vector a = Scalar(0.999) - Vector{};
  Vector b = Scalar(1e-3) - Vector{};
  asm volatile("" : "+m"(a), "+m"(b));
  for (int k = 0; k < kLoops; ++k) {
#pragma GCC unroll 16
    for (int i = 0; i < kChains; ++i) c[i] = c[i] * a + b;
  }
  Vector sum = c[0];
  for (int i = 1; i < kChains; ++i) sum += c[i];
  return sum[0];
}

#if defined(__x86_64__)
__attribute__((target("avx512f"))) Scalar chains_avx512() { return chains<64>(); }
__attribute__((target("avx2,fma"))) Scalar chains_avx2() { return chains<32>(); }
#endif
Scalar chains_baseline() { return chains<16>(); }

double flops_per_us(Scalar (*run)(), int bytes) {
  double best = 0;
  for (int r = 0; r < 15; ++r) {
    const auto begin = Clock::now();
    volatile Scalar keep = run();
    (void)keep;
    const double flops = 2.0 * kChains * kLoops * bytes / static_cast<double>(sizeof(Scalar));
    best = std::max(best, flops / us_since(begin));
  }
  return best;
}

template <int kBytes>
inline __attribute__((always_inline)) void touch(char* data, int bytes) {
  using Vector = typename Wide<kBytes>::Type;
  Vector one = Scalar(1) - Vector{};
  for (int i = 0; i + 4 * kBytes <= bytes; i += 4 * kBytes) {
    Vector* v = reinterpret_cast<Vector*>(data + i);
    v[0] -= one;
    v[1] -= one;
    v[2] -= one;
    v[3] -= one;
  }
}

#if defined(__x86_64__)
__attribute__((target("avx512f"))) void touch_avx512(char* data, int bytes) { touch<64>(data, bytes); }
__attribute__((target("avx2"))) void touch_avx2(char* data, int bytes) { touch<32>(data, bytes); }
#endif
void touch_baseline(char* data, int bytes) { touch<16>(data, bytes); }

}  // namespace

double peak_flops_per_us() {
  double best = flops_per_us(chains_baseline, 16);
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
    best = std::max(best, flops_per_us(chains_avx2, 32));
  }
  if (__builtin_cpu_supports("avx512f")) best = std::max(best, flops_per_us(chains_avx512, 64));
#endif
  return best;
}

double bandwidth_per_us(int bytes) {
  std::vector<char> storage(static_cast<std::size_t>(bytes) + 64, 0);
  char* data = storage.data() + 64 - reinterpret_cast<std::uintptr_t>(storage.data()) % 64;
  void (*run)(char*, int) = touch_baseline;
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2")) run = touch_avx2;
  if (__builtin_cpu_supports("avx512f")) run = touch_avx512;
#endif
  std::vector<double> samples;
  run(data, bytes);
  for (int r = 0; r < 31; ++r) {
    const auto begin = Clock::now();
    for (int k = 0; k < 8; ++k) run(data, bytes);
    samples.push_back(8.0 * 2.0 * bytes / us_since(begin));
  }
  std::nth_element(samples.begin(), samples.begin() + 15, samples.end());
  return samples[15];
}

double update_limit_us(int n, int m, int c, double flops, double bytes) {
  const double flop = 1.0 * n * n * m + 2.0 * n * m * c + 1.0 * n * m * m + 1.0 * m * m * m / 3;
  return flop / flops + 1.0 * n * n * static_cast<double>(sizeof(Scalar)) / bytes;
}

}  // namespace bench
