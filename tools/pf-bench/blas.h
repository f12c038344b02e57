#pragma once

#include <string>
#include <vector>

#include "base/scalar.h"

namespace bench {

/// A BLAS that is installed on this machine, held to one thread and to the core type that fits the processor.
struct Blas {
  std::string name;
  using Syrk = void (*)(const char* uplo, const char* trans, const int* n, const int* k, const pf::Scalar* alpha,
                        const pf::Scalar* A, const int* lda, const pf::Scalar* beta, pf::Scalar* C, const int* ldc);
  Syrk syrk;

  /// C (n x n, one triangle) -= W^T W for W (m x n, row-major, leading dimension ld).
  void downdate(char uplo, pf::Scalar* C, int ldc, const pf::Scalar* W, int m, int n, int ld) const;
};

/// OpenBLAS and BLIS, where the loader finds them.
std::vector<Blas> installed_blas();

}  // namespace bench
