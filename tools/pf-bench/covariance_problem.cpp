#include "covariance_problem.h"

#include <cstdlib>
#include <cstring>
#include <random>

namespace bench {

using pf::SparseRows;
using pf::Triangle;

Aligned::Aligned(std::size_t count) : storage_(count + 64, 0), size_(count) {
  const std::size_t misplaced = reinterpret_cast<std::uintptr_t>(storage_.data()) % 64;
  data_ = storage_.data() + (misplaced == 0 ? 0 : (64 - misplaced) / sizeof(Scalar));
}

Problem::Problem(int rows, int measured)
    : n(rows),
      m(measured),
      ld(pf::padded(rows)),
      lds(measured),
      start(Triangle::size_for(rows + 8)),
      values(Triangle::size_for(rows + 8)),
      W(static_cast<std::size_t>(measured) * ld),
      U(static_cast<std::size_t>(8) * ld),
      G(static_cast<std::size_t>(8) * ld),
      S(static_cast<std::size_t>(measured) * lds),
      innovation(static_cast<std::size_t>(measured)),
      y(static_cast<std::size_t>(measured) * pf::padded(1)),
      whitened(static_cast<std::size_t>(measured)),
      dx(static_cast<std::size_t>(rows)),
      variance(Scalar(0.5)) {
  std::mt19937_64 random(2008);
  std::normal_distribution<double> normal;
  P.data = start.data();
  P.n = n;
  P.capacity = (n + 15) / 8 * 8;
  std::vector<double> factor(static_cast<std::size_t>(n) * 6);
  for (double& f : factor) f = normal(random);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j <= i; ++j) {
      double sum = i == j ? 0.5 : 0;
      for (int c = 0; c < 6; ++c) sum += factor[i * 6 + c] * factor[j * 6 + c] / 6;
      P.row(i)[j] = static_cast<Scalar>(sum);
    }
  }
  P.data = values.data();
  restore();

  const int points = (n - kBody - kPoint) / kPoint;
  for (int i = 0; i < m / 2; ++i) {
    pf::StoredRows rows_of_point;
    rows_of_point.rows = 2;
    const int point = kBody + kPoint + kPoint * (i * points / (m / 2));
    rows_of_point.segment[rows_of_point.segments++] = {0, kBody};
    if (i % 10 == 5) rows_of_point.segment[rows_of_point.segments++] = {kBody, kPoint};
    rows_of_point.segment[rows_of_point.segments++] = {point, kPoint};
    for (int c = 0; c < 2 * rows_of_point.columns(); ++c) {
      rows_of_point.h[c] = static_cast<Scalar>(normal(random));
    }
    stored.push_back(rows_of_point);
  }
  J.assign(stored.begin(), stored.end());
  for (Scalar& r : innovation) r = static_cast<Scalar>(normal(random));
  for (int k = 0; k < 8; ++k) {
    for (int j = 0; j < n; ++j) {
      const bool shift = k >= pf::Kernels::kDenseRows;  // moves the heights of planes alone
      if (!shift || (j - kBody) % (n / kPlanes) == 2) U.data()[k * ld + j] = static_cast<Scalar>(1e-3 * normal(random));
      G.data()[k * ld + j] = static_cast<Scalar>(1e-3 * normal(random));
    }
  }
}

void Problem::restore() {
  std::memcpy(values.data(), start.data(), start.size() * sizeof(Scalar));
  P.n = n;
}

void Problem::update(const pf::Kernels& kernels, int held_first, int held_end, int transport) {
  kernels.gather_many(P, J.data(), static_cast<int>(J.size()), W.data(), ld);
  kernels.project(W.data(), m, ld, J.data(), static_cast<int>(J.size()), S.data(), lds);
  for (int i = 0; i < m; ++i) {
    S.data()[static_cast<std::ptrdiff_t>(i) * lds + i] += variance;
    y[static_cast<std::size_t>(i) * pf::padded(1)] = innovation[static_cast<std::size_t>(i)];
  }
  if (!kernels.cholesky(S.data(), m, lds)) std::abort();
  kernels.solve_lower(S.data(), m, lds, W.data(), n, ld);
  kernels.solve_lower(S.data(), m, lds, y.data(), 1, pf::padded(1));
  for (int i = 0; i < m; ++i) whitened[static_cast<std::size_t>(i)] = y[static_cast<std::size_t>(i) * pf::padded(1)];
  kernels.combine(W.data(), m, n, ld, whitened.data(), dx.data());
  kernels.downdate(P, W.data(), m, U.data(), G.data(), transport, ld, held_first, held_end);
}

std::vector<Scalar> Problem::dense_covariance() const {
  Triangle at = P;
  at.data = const_cast<Scalar*>(start.data());
  std::vector<Scalar> out(static_cast<std::size_t>(n) * n);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) out[static_cast<std::size_t>(i) * n + j] = at(i, j);
  }
  return out;
}

std::vector<Scalar> Problem::dense_rows() const {
  std::vector<Scalar> out(static_cast<std::size_t>(m) * n, 0);
  std::size_t row = 0;
  for (const SparseRows& rows : J) {
    for (int a = 0; a < rows.rows; ++a, ++row) {
      const Scalar* h = rows.h + a * rows.columns();
      for (int s = 0; s < rows.segments; ++s) {
        for (int c = 0; c < rows.segment[s].size; ++c) out[row * n + rows.segment[s].first + c] = *h++;
      }
    }
  }
  return out;
}

double touched_columns(const Problem& problem) {
  double sum = 0;
  for (const SparseRows& rows : problem.J) sum += rows.columns();
  return sum / static_cast<double>(problem.J.size());
}

}  // namespace bench
