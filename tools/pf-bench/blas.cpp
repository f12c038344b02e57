#include "blas.h"

#include <dlfcn.h>

#include <cstdlib>

namespace bench {
namespace {

/// Old releases do not know new processors and fall back to slow code: say what it is, unless the user has.
void pin_environment() {
  for (const char* name : {"OPENBLAS_NUM_THREADS", "BLIS_NUM_THREADS", "OMP_NUM_THREADS"}) setenv(name, "1", 1);
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq")) {
    setenv("OPENBLAS_CORETYPE", "SkylakeX", 0);
  } else if (__builtin_cpu_supports("avx2")) {
    setenv("OPENBLAS_CORETYPE", "Haswell", 0);
  }
#endif
}

}  // namespace

void Blas::downdate(char uplo, pf::Scalar* C, int ldc, const pf::Scalar* W, int m, int n, int ld) const {
  // Row-major m x n is column-major n x m.
  const pf::Scalar minus = -1, one = 1;
  syrk(&uplo, "N", &n, &m, &minus, W, &ld, &one, C, &ldc);
}

std::vector<Blas> installed_blas() {
  pin_environment();
  const char* symbol = sizeof(pf::Scalar) == 8 ? "dsyrk_" : "ssyrk_";
  const struct {
    const char* name;
    const char* files[3];
  } candidates[] = {{"openblas", {"libopenblas.so.0", "libopenblas.so", nullptr}},
                    {"blis", {"libblis.so.4", "libblis.so.3", "libblis.so"}}};
  std::vector<Blas> found;
  for (const auto& candidate : candidates) {
    for (const char* file : candidate.files) {
      void* library = file != nullptr ? dlopen(file, RTLD_NOW | RTLD_LOCAL) : nullptr;
      void* function = library != nullptr ? dlsym(library, symbol) : nullptr;
      if (function == nullptr) continue;
      found.push_back({candidate.name, reinterpret_cast<Blas::Syrk>(function)});
      break;
    }
  }
  return found;
}

}  // namespace bench
