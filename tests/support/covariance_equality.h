#pragma once

// Every kernel set against the reference, and against itself at other addresses: random covariances, random blocks.

#include <cstdio>
#include <cstring>
#include <functional>

#include "covariance/select.h"
#include "covariance_cases.h"
#include "unity.h"

namespace covariance_cases {

using pf::Kernels;
using pf::Segment;
using pf::SparseRows;
using pf::StoredRows;
using pf::Triangle;

constexpr double kTolerance = kFloat ? 1e-5 : 1e-12;
constexpr const char* kSetNames[] = {"auto", "reference", "portable", "avx2", "avx512", "neon"};

/// What one round does, drawn once and then run on several sets.
struct Problem {
  int n, m, k, held_first, held_end;
  Covariance start;
  std::vector<StoredRows> J;
  std::vector<double> noise;  // sigma^2 of each row
  Thin U, G;
  std::vector<Scalar> F, Q;
  StoredRows added, replaced;
  Scalar added_noise[SparseRows::kMaxRows * SparseRows::kMaxRows];
  int replaced_first, replaced_size;
  std::vector<Segment> gone;
  std::vector<Segment> folded;
  std::vector<StoredRows> folds;
};

inline std::vector<Scalar> random_block(Random& random, int rows, double scale) {
  std::vector<Scalar> A(static_cast<std::size_t>(rows) * rows);
  for (Scalar& a : A) a = static_cast<Scalar>(scale * random.normal());
  return A;
}

inline Problem draw(Random& random, int largest) {
  const int n = random.integer(8, random.integer(8, largest));
  Problem p = {
      n,  0, random.integer(0, 8), 0, 0, Covariance(n, n), {}, {}, Thin(8, n), Thin(8, n), {}, {}, {}, {}, {}, 0, 0, {},
      {}, {}};
  randomise(random, p.start.P);
  if (random.integer(0, 1) == 0) {
    p.held_first = random.integer(0, n);
    p.held_end = random.integer(0, 3) == 0 ? n : random.integer(0, n);
  }
  const int measurements = random.integer(1, random.integer(1, 20));
  for (int i = 0; i < measurements; ++i) {
    p.J.push_back(random_rows(random, random.integer(0, 9) == 0 ? random.integer(1, SparseRows::kMaxRows) : 2, n, 3));
    p.m += p.J.back().rows;
  }
  for (int i = 0; i < p.m; ++i) p.noise.push_back(random.uniform(0.1, 1));
  p.U.randomise(random, 0.01);
  if (random.integer(0, 3) > 0) keep_few(random, p.U);
  p.G.randomise(random, 0.01);
  const int b = random.integer(1, std::min(n, 15));
  p.F = random_block(random, b, 0.3);
  p.Q = random_block(random, b, 0.01);
  for (int i = 0; i < b; ++i) {
    p.F[i * b + i] += 1;
    for (int j = 0; j < i; ++j) p.Q[i * b + j] = p.Q[j * b + i];
  }
  p.added = random_rows(random, random.integer(1, SparseRows::kMaxRows), n, 4);
  for (Scalar& q : p.added_noise) q = static_cast<Scalar>(random.uniform(0, 1));
  p.replaced_size = random.integer(1, 6);
  p.replaced_first = random.integer(0, n - p.replaced_size);
  p.replaced = random_rows(random, random.integer(1, p.replaced_size), n, 4);
  for (int at = random.integer(0, 9); at < n; at += random.integer(1, 20)) {
    const int size = std::min(random.integer(1, 7), n - at);
    p.gone.push_back({at, size});
    at += size;
  }
  for (int at = random.integer(0, 9); at < n; at += random.integer(0, 20)) {
    const int size = std::min(random.integer(1, 6), n - at);
    p.folded.push_back({at, size});
    at += size;
    p.folds.push_back(random_rows(random, random.integer(0, size), n, 3));
  }
  return p;
}

/// Results of all operations, one after the other, as one list of numbers, each with the scale that its error is held against.
struct Trace {
  std::vector<Scalar> value;
  std::vector<double> scale;
  bool finite = true;

  void add(Scalar v, double s) {
    value.push_back(v);
    scale.push_back(s);
    finite = finite && std::isfinite(v);
  }
  void add(const Triangle& P, const Triangle& before) {
    // Errors are held against the larger of the standard deviations before and after.
    std::vector<double> sigma(static_cast<std::size_t>(P.n));
    for (int i = 0; i < P.n; ++i) {
      sigma[i] = std::fabs(static_cast<double>(P(i, i)));
      if (i < before.n) sigma[i] = std::max(sigma[i], static_cast<double>(before(i, i)));
      sigma[i] = std::sqrt(sigma[i]);
    }
    for (int i = 0; i < P.n; ++i) {
      for (int j = 0; j <= i; ++j) add(P.row(i)[j], sigma[i] * sigma[j]);
      for (int j = i + 1; j < i / 8 * 8 + 8; ++j) finite = finite && std::isfinite(P.row(i)[j]);
    }
  }
};

/// Standard deviation that the errors of row a of J x are held against.
inline double sigma_of(const SparseRows& J, int a, const Triangle& P) {
  double sum = 0;
  int c = 0;
  for (int s = 0; s < J.segments; ++s) {
    for (int i = 0; i < J.segment[s].size; ++i, ++c) {
      const int at = J.segment[s].first + i;
      sum += std::fabs(static_cast<double>(J.h[a * J.columns() + c])) * std::sqrt(static_cast<double>(P(at, at)));
    }
  }
  return sum;
}

struct Place {
  int shift;
  Scalar poison;
};

/// gather, innovation, Cholesky, gain, downdate: P is updated, everything on the way is kept in the trace.
inline void update(const Kernels& kernels, Problem& p, Triangle& P, Place place, Trace& trace) {
  const int n = p.n, m = p.m;
  Thin W(m, n, place.shift, place.poison), other(m, n, place.shift, place.poison);
  kernels.gather_many(P, views(p.J).data(), static_cast<int>(p.J.size()), W.data(), W.ld);
  std::vector<double> sigma;
  int row = 0;
  for (const StoredRows& J : p.J) {
    kernels.gather(P, J, &other.at(row, 0), other.ld);
    for (int a = 0; a < J.rows; ++a, ++row) {
      sigma.push_back(sigma_of(J, a, P));
      for (int j = 0; j < n; ++j) {
        const double scale = sigma.back() * std::sqrt(static_cast<double>(P(j, j)));
        trace.add(W.at(row, j), scale);
        trace.add(other.at(row, j), scale);
      }
    }
  }

  // Innovation covariance, in units in which its diagonal is about one.
  const int lds = m + m % 3;
  Buffer S(static_cast<std::size_t>(m) * lds, place.shift, place.poison);
  for (int i = 0; i < m; ++i) {
    for (int j = 0; j < n; ++j) W.at(i, j) = static_cast<Scalar>(static_cast<double>(W.at(i, j)) / sigma[i]);
  }
  // With rows of W and of J divided by sigma, S has the noise on top of a matrix of that size.
  std::vector<StoredRows> J = p.J;
  int b = 0;
  for (StoredRows& rows : J) {
    for (int a = 0; a < rows.rows; ++a, ++b) {
      for (int c = 0; c < rows.columns(); ++c) {
        Scalar& h = rows.h[a * rows.columns() + c];
        h = static_cast<Scalar>(static_cast<double>(h) / sigma[b]);
      }
    }
  }
  kernels.project(W.data(), m, W.ld, views(J).data(), static_cast<int>(J.size()), S.data(), lds);
  Buffer some(static_cast<std::size_t>(m) * lds, place.shift, place.poison);
  const int half = static_cast<int>(J.size()) / 2;
  kernels.project(W.data(), m, W.ld, views(J).data(), half, some.data(), lds);
  for (int h = 0, c = 0; h < half; ++h) {
    for (int a = 0; a < J[h].rows; ++a, ++c) {
      for (int i = c; i < m; ++i) trace.add(some[static_cast<std::size_t>(i) * lds + c], 1);
    }
  }
  for (int i = 0; i < m; ++i) {
    for (int j = 0; j <= i; ++j) trace.add(S[static_cast<std::size_t>(i) * lds + j], 1);
    S[static_cast<std::size_t>(i) * lds + i] += static_cast<Scalar>(p.noise[i]);
  }
  TEST_ASSERT_TRUE(kernels.cholesky(S.data(), m, lds));
  for (int i = 0; i < m; ++i) {
    for (int j = 0; j <= i; ++j) trace.add(S[static_cast<std::size_t>(i) * lds + j], 1);
  }
  kernels.solve_lower(S.data(), m, lds, W.data(), n, W.ld);

  Thin y(m, 1, place.shift, place.poison);
  std::vector<Scalar> whitened;
  for (int i = 0; i < m; ++i) y.at(i, 0) = static_cast<Scalar>(p.noise[i]);
  kernels.solve_lower(S.data(), m, lds, y.data(), 1, y.ld);
  for (int i = 0; i < m; ++i) whitened.push_back(y.at(i, 0));
  Buffer x(n, place.shift, place.poison);
  kernels.combine(W.data(), m, n, W.ld, whitened.data(), x.data());
  for (int j = 0; j < n; ++j) trace.add(x[j], m * std::sqrt(static_cast<double>(P(j, j))));
  const int k = std::min(m, 8);
  Thin C(k, n, place.shift, place.poison);
  for (int i = 0; i < k; ++i) {
    for (int j = 0; j < C.ld; ++j) C.at(i, j) = W.at(i, j);
  }
  const std::vector<Scalar> A(static_cast<std::size_t>(k) * (m + 1), Scalar(0.3));
  kernels.add_product(C.data(), k, A.data(), m + 1, W.data(), m, n, W.ld);
  for (int i = 0; i < k; ++i) {
    for (int j = 0; j < n; ++j) trace.add(C.at(i, j), m * std::sqrt(static_cast<double>(P(j, j))));
  }

  Covariance before(n, n);
  before.copy_from(P);
  kernels.downdate(P, W.data(), m, p.U.data(), p.G.data(), p.k, W.ld, p.held_first, p.held_end);
  trace.add(P, before.P);
}

inline Trace run(const Kernels& kernels, Problem& p, Place place) {
  Trace trace;
  {
    Covariance c(p.n, p.n, place.shift, place.poison);
    c.copy_from(p.start.P);
    update(kernels, p, c.P, place, trace);
  }
  const auto each = [&](const std::function<void(Triangle&)>& operation, const Triangle& before = Triangle()) {
    Covariance c(p.n, p.n + SparseRows::kMaxRows, place.shift, place.poison);
    c.copy_from(p.start.P);
    operation(c.P);
    trace.add(c.P, before);
  };
  int b = 0;
  while (b * b < static_cast<int>(p.F.size())) ++b;
  // F may take nearly all of a variance away; rows stay where they are, so that it can be held against what it was.
  each([&](Triangle& P) { kernels.predict(P, p.F.data(), p.Q.data(), b); }, p.start.P);
  each([&](Triangle& P) { kernels.augment(P, p.added, p.added_noise); });
  each([&](Triangle& P) { kernels.remove(P, p.gone.data(), static_cast<int>(p.gone.size())); });
  each([&](Triangle& P) {
    int rows = 0;
    for (const StoredRows& J : p.folds) rows += J.rows;
    Thin X(rows, p.n, place.shift, place.poison);
    Buffer S(static_cast<std::size_t>(rows) * rows, place.shift, place.poison);
    kernels.transform_many(P, p.folded.data(), views(p.folds).data(), static_cast<int>(p.folds.size()), X.data(), X.ld,
                           S.data(), rows);
  });
  each([&](Triangle& P) { kernels.transform(P, p.replaced_first, p.replaced_size, p.replaced, p.added_noise); });
  each([&](Triangle& P) { kernels.replace(P, p.replaced_first, p.replaced_size, p.replaced, nullptr); });
  return trace;
}

/// Compare one set with the reference and with itself elsewhere, over `rounds` problems of up to `largest` rows.
inline void check_set(std::uint32_t id, int rounds, int largest, std::uint64_t seed) {
  const Kernels* kernels = pf::select_kernels(id);
  if (kernels == nullptr) TEST_IGNORE_MESSAGE("this processor or build has no such set");
  TEST_ASSERT_EQUAL_UINT32(id, pf::kernels_id(kernels));
  std::printf("%s: %d rounds, seed %llu\n", kSetNames[id], rounds, static_cast<unsigned long long>(seed));
  Random random(seed);
  double worst = 0;
  for (int round = 0; round < rounds; ++round) {
    Problem p = draw(random, largest);
    const Trace expected = run(pf::reference_kernels(), p, {0, kNaN});
    const Trace actual = run(*kernels, p, {0, kNaN});
    TEST_ASSERT_TRUE_MESSAGE(expected.finite && actual.finite, "not finite");
    TEST_ASSERT_EQUAL_size_t(expected.value.size(), actual.value.size());
    for (std::size_t i = 0; i < actual.value.size(); ++i) {
      const double error = std::fabs(static_cast<double>(expected.value[i]) - static_cast<double>(actual.value[i]));
      worst = std::max(worst, error / expected.scale[i]);
    }
    TEST_ASSERT_TRUE_MESSAGE(worst <= kTolerance, "too far from the reference");
    const Trace again = run(*kernels, p, {random.integer(1, 15), Scalar(-3e30)});
    TEST_ASSERT_EQUAL_MEMORY_MESSAGE(actual.value.data(), again.value.data(), actual.value.size() * sizeof(Scalar),
                                     "other bits at another address");
  }
  std::printf("%s: largest difference %.2e of sqrt(P_ii P_jj)\n", kSetNames[id], worst);
}

}  // namespace covariance_cases
