#pragma once

#include "covariance/kernels.h"

/// The plain twins: one loop nest per formula, no blocking. They define what the tuned sets must compute, and are the easiest to read.

namespace pf::reference {

/// Column of the state that a column of J.h stands for.
int state_column(const SparseRows& J, int column);

/// (J P)(a, j)
Scalar product(const SparseRows& J, int a, const Triangle& P, int j);

/// out (J.rows x J.rows, leading dimension kMaxRows, both halves) = J P J^T.
void square(const SparseRows& J, const Triangle& P, Scalar* out);

void gather(const Triangle& P, const SparseRows& J, Scalar* out, int ld);
void gather_many(const Triangle& P, const SparseRows* J, int count, Scalar* out, int ld);
bool cholesky(Scalar* S, int m, int lds);
void solve_lower(const Scalar* L, int m, int lds, Scalar* X, int n, int ld);
void downdate(Triangle& P, const Scalar* W, int m, const Scalar* U, const Scalar* G, int k, int ld, int held_first,
              int held_end);
void predict(Triangle& P, const Scalar* F, const Scalar* Q, int b);
void augment(Triangle& P, const SparseRows& J, const Scalar* noise);
void transform(Triangle& P, int first, int size, const SparseRows& J, const Scalar* noise);
void replace(Triangle& P, int first, int size, const SparseRows& J, const Scalar* noise);
void transform_many(Triangle& P, const Segment* block, const SparseRows* J, int count, Scalar* X, int ld, Scalar* S,
                    int lds);
void remove(Triangle& P, const Segment* gone, int count);
void project(const Scalar* X, int m, int ld, const SparseRows* J, int count, Scalar* S, int lds);
void combine(const Scalar* W, int m, int n, int ld, const Scalar* y, Scalar* x);
void add_product(Scalar* C, int k, const Scalar* A, int lda, const Scalar* B, int m, int n, int ld);

}  // namespace pf::reference
