// The reference kernels against the textbook's dense formulas in double.
#include <Eigen/Dense>
#include <cstdio>

#include "covariance_cases.h"
#include "same.h"
#include "unity.h"

namespace {

using covariance_cases::Covariance;
using covariance_cases::kFloat;
using covariance_cases::Random;
using covariance_cases::Thin;
using covariance_cases::views;
using Dense = Eigen::MatrixXd;
using pf::Scalar;
using pf::Segment;
using pf::SparseRows;
using pf::StoredRows;
using pf::Triangle;

constexpr std::uint64_t kSeed = 4;
constexpr int kRounds = 40;
constexpr double kTolerance = kFloat ? 1e-4 : 1e-12;

const pf::Kernels& kernels = pf::reference_kernels();

Dense dense(const Triangle& P) {
  Dense D(P.n, P.n);
  for (int i = 0; i < P.n; ++i) {
    for (int j = 0; j < P.n; ++j) D(i, j) = static_cast<double>(P(i, j));
  }
  return D;
}

Dense dense(Thin& A) {
  Dense D(A.rows, A.columns);
  for (int i = 0; i < A.rows; ++i) {
    for (int j = 0; j < A.columns; ++j) D(i, j) = static_cast<double>(A.at(i, j));
  }
  return D;
}

Dense dense(const SparseRows& J, int n) {
  Dense D = Dense::Zero(J.rows, n);
  for (int a = 0; a < J.rows; ++a) {
    int c = 0;
    for (int s = 0; s < J.segments; ++s) {
      for (int i = 0; i < J.segment[s].size; ++i, ++c) {
        D(a, J.segment[s].first + i) = static_cast<double>(J.h[a * J.columns() + c]);
      }
    }
  }
  return D;
}

Dense random_square(Random& random, int n) {
  Dense A(n, n);
  for (int i = 0; i < n * n; ++i) A.data()[i] = static_cast<double>(static_cast<Scalar>(random.normal()));
  return A;
}

/// Row-major copy in the library's scalar.
std::vector<Scalar> flat(const Dense& A) {
  std::vector<Scalar> out;
  for (int i = 0; i < A.rows(); ++i) {
    for (int j = 0; j < A.cols(); ++j) out.push_back(static_cast<Scalar>(A(i, j)));
  }
  return out;
}

void assert_near(const Dense& expected, const Dense& actual) {
  TEST_ASSERT_EQUAL_INT(expected.rows(), actual.rows());
  TEST_ASSERT_EQUAL_INT(expected.cols(), actual.cols());
  const double scale = 1 + expected.cwiseAbs().maxCoeff();
  TEST_ASSERT_TRUE(((expected - actual).cwiseAbs().array() <= kTolerance * scale).all());
}

void assert_padding_is_finite(const Triangle& P) {
  for (int i = 0; i < P.n; ++i) {
    for (int j = i + 1; j < i / 8 * 8 + 8; ++j) TEST_ASSERT_TRUE(std::isfinite(P.row(i)[j]));
  }
}

struct Round {
  Random random;
  Covariance covariance;
  Triangle& P;
  explicit Round(int seed, int at_least = 20, int at_most = 70)
      : random(kSeed + static_cast<std::uint64_t>(seed)),
        covariance(random.integer(at_least, at_most), at_most + 24),
        P(covariance.P) {
    randomise(random, P);
  }
};

void test_triangle_should_address_every_element_once_when_packed() {
  const int n = 83;
  std::vector<int> seen(Triangle::size_for(n), 0);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j <= i; ++j) ++seen.at(Triangle::offset(i) + static_cast<std::size_t>(j));
  }
  for (int count : seen) TEST_ASSERT_TRUE(count <= 1);
  for (int i = 0; i < n; ++i) TEST_ASSERT_EQUAL_size_t(0, Triangle::offset(i) % 8);
}

void test_gather_should_equal_the_dense_product_when_blocks_are_random() {
  for (int i = 0; i < kRounds; ++i) {
    Round r(i);
    const StoredRows J = random_rows(r.random, r.random.integer(1, SparseRows::kMaxRows), r.P.n, 4);
    Thin out(J.rows, r.P.n);
    kernels.gather(r.P, J, out.data(), out.ld);
    assert_near(dense(J, r.P.n) * dense(r.P), dense(out));
  }
}

void test_gather_many_should_stack_the_single_gathers_when_given_a_list() {
  Round r(0);
  const std::vector<StoredRows> J = {random_rows(r.random, 2, r.P.n, 3), random_rows(r.random, 3, r.P.n, 3)};
  Thin out(5, r.P.n);
  kernels.gather_many(r.P, views(J).data(), 2, out.data(), out.ld);
  Dense H(5, r.P.n);
  H << dense(J[0], r.P.n), dense(J[1], r.P.n);
  assert_near(H * dense(r.P), dense(out));
}

void test_cholesky_and_solve_should_invert_the_product_when_positive_definite() {
  for (int i = 0; i < kRounds; ++i) {
    Random random(kSeed + i);
    const int m = random.integer(1, 30);
    const int lds = m + random.integer(0, 3);
    const Dense A = random_square(random, m);
    Dense S = A * A.transpose() + m * Dense::Identity(m, m);
    std::vector<Scalar> L(static_cast<std::size_t>(m) * lds, covariance_cases::kNaN);
    for (int a = 0; a < m; ++a) {
      for (int b = 0; b <= a; ++b) L[a * lds + b] = static_cast<Scalar>(S(a, b));
    }
    TEST_ASSERT_TRUE(kernels.cholesky(L.data(), m, lds));
    const Dense expected = S.llt().matrixL();
    for (int a = 0; a < m; ++a) {
      for (int b = 0; b <= a; ++b) {
        TEST_ASSERT_TRUE(std::fabs(expected(a, b) - static_cast<double>(L[a * lds + b])) < kTolerance * m * 10);
      }
    }
    Thin X(m, 19);
    X.randomise(random, 1);
    const Dense before = dense(X);
    kernels.solve_lower(L.data(), m, lds, X.data(), 19, X.ld);
    assert_near(expected.triangularView<Eigen::Lower>().solve(before), dense(X));
  }
}

void test_cholesky_should_refuse_when_a_pivot_is_not_positive() {
  Scalar indefinite[4] = {1, 2, 2, 1};
  TEST_ASSERT_FALSE(kernels.cholesky(indefinite, 2, 2));
  Scalar zero[1] = {0};
  TEST_ASSERT_FALSE(kernels.cholesky(zero, 1, 1));
  Scalar nan[1] = {covariance_cases::kNaN};
  TEST_ASSERT_FALSE(kernels.cholesky(nan, 1, 1));
}

void test_downdate_should_equal_the_dense_formula_when_rows_are_considered_and_transported() {
  for (int i = 0; i < kRounds; ++i) {
    Round r(i);
    const int n = r.P.n, m = r.random.integer(1, 25), k = r.random.integer(0, 8);
    const int held_first = r.random.integer(0, n);
    const int held_end = i % 2 == 0 ? held_first : r.random.integer(held_first, n);
    const int held = held_end - held_first;
    Thin W(m, n), U(k, n), G(k, n);
    W.randomise(r.random, 0.1);
    U.randomise(r.random, 0.1);
    if (i % 3 == 0) covariance_cases::keep_few(r.random, U);
    G.randomise(r.random, 0.1);
    Dense gained = dense(W).transpose() * dense(W);
    gained.block(held_first, held_first, held, held).setZero();
    const Dense moved = dense(U).transpose() * dense(G);
    const Dense expected = dense(r.P) - gained + moved + moved.transpose();
    kernels.downdate(r.P, W.data(), m, U.data(), G.data(), k, W.ld, held_first, held_end);
    assert_near(expected, dense(r.P));
    assert_padding_is_finite(r.P);
  }
}

void test_predict_should_equal_the_dense_formula_when_the_leading_block_moves() {
  for (int i = 0; i < kRounds; ++i) {
    Round r(i, 1, 50);
    const int n = r.P.n, b = r.random.integer(1, std::min(n, 15));
    const Dense F = random_square(r.random, b);
    const Dense A = random_square(r.random, b);
    const Dense Q = A * A.transpose();
    Dense whole = Dense::Identity(n, n);
    whole.topLeftCorner(b, b) = F;
    Dense expected = whole * dense(r.P) * whole.transpose();
    expected.topLeftCorner(b, b) += Q;
    kernels.predict(r.P, flat(F).data(), flat(Q).data(), b);
    assert_near(expected, dense(r.P));
    assert_padding_is_finite(r.P);
  }
}

void test_augment_should_append_the_dense_product_when_n_is_no_multiple_of_eight() {
  for (int i = 0; i < kRounds; ++i) {
    Round r(i);
    const int n = r.P.n, rows = r.random.integer(1, SparseRows::kMaxRows);
    const StoredRows J = random_rows(r.random, rows, n, 3);
    const Dense A = random_square(r.random, rows);
    const Dense noise = A * A.transpose();
    Dense whole(n + rows, n);
    whole << Dense::Identity(n, n), dense(J, n);
    Dense expected = whole * dense(r.P) * whole.transpose();
    expected.bottomRightCorner(rows, rows) += noise;
    kernels.augment(r.P, J, flat(noise).data());
    TEST_ASSERT_EQUAL_INT(n + rows, r.P.n);
    assert_near(expected, dense(r.P));
    assert_padding_is_finite(r.P);
  }
}

void test_augment_should_begin_a_state_when_the_triangle_is_empty() {
  Covariance empty(0, 16);
  SparseRows J;
  J.rows = 3;
  const Scalar noise[9] = {4, 1, 0, 1, 5, 2, 0, 2, 6};
  kernels.augment(empty.P, J, noise);
  TEST_ASSERT_EQUAL_INT(3, empty.P.n);
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b < 3; ++b) TEST_ASSERT_SAME(noise[3 * a + b], empty.P(a, b));
  }
  assert_padding_is_finite(empty.P);
}

/// The map of the whole state that replaces a block and drops what is left of it.
Dense whole_map(const SparseRows& J, int n, int first, int size) {
  Dense M = Dense::Zero(n - size + J.rows, n);
  M.topLeftCorner(first, first).setIdentity();
  M.middleRows(first, J.rows) = dense(J, n);
  M.bottomRightCorner(n - first - size, n - first - size).setIdentity();
  return M;
}

void test_transform_should_equal_the_dense_map_when_the_block_shrinks() {
  for (int i = 0; i < kRounds; ++i) {
    Round r(i);
    const int n = r.P.n, size = r.random.integer(1, 6), rows = r.random.integer(1, size);
    const int first = r.random.integer(0, n - size);
    StoredRows J = random_rows(r.random, rows, n, 3);
    if (i % 2 == 0) {
      J.segments = 1;
      J.segment[0] = {first, size};
    }
    const Dense A = random_square(r.random, rows);
    const Dense noise = i % 3 == 0 ? Dense::Zero(rows, rows) : Dense(A * A.transpose());
    const Dense M = whole_map(J, n, first, size);
    Dense expected = M * dense(r.P) * M.transpose();
    expected.block(first, first, rows, rows) += noise;
    kernels.transform(r.P, first, size, J, i % 3 == 0 ? nullptr : flat(noise).data());
    TEST_ASSERT_EQUAL_INT(n - size + rows, r.P.n);
    assert_near(expected, dense(r.P));
    assert_padding_is_finite(r.P);
  }
}

void test_replace_should_leave_the_gap_for_one_removal_when_many_blocks_shrink() {
  Round r(0, 40, 60);
  Covariance other(r.P.n, 96);
  other.copy_from(r.P);
  StoredRows J[2];
  for (int i = 0; i < 2; ++i) J[i] = random_rows(r.random, 2, r.P.n, 2);
  kernels.transform(r.P, 30, 3, J[1], nullptr);
  const StoredRows& second = J[0];
  // The second map's columns are those before the gap, so that both ways mean the same states.
  StoredRows low = second;
  low.segments = 1;
  low.segment[0] = {0, second.columns() > 20 ? 20 : second.columns()};
  kernels.transform(r.P, 21, 3, low, nullptr);

  kernels.replace(other.P, 30, 3, J[1], nullptr);
  kernels.replace(other.P, 21, 3, low, nullptr);
  const Segment gaps[2] = {{23, 1}, {32, 1}};
  kernels.remove(other.P, gaps, 2);
  assert_near(dense(r.P), dense(other.P));
}

void test_transform_many_should_equal_the_dense_map_when_blocks_shrink_and_go() {
  for (int i = 0; i < kRounds; ++i) {
    Round r(i);
    const int n = r.P.n;
    std::vector<Segment> blocks;
    std::vector<StoredRows> J;
    Dense M(n, n);
    int row = 0, rows = 0;
    for (int at = 0; at < n;) {
      const int kept = std::min(r.random.integer(0, 12), n - at);
      for (int j = 0; j < kept; ++j, ++at) M.row(row++) = Dense::Identity(n, n).row(at);
      if (at == n) break;
      const int size = std::min(r.random.integer(1, 6), n - at);
      blocks.push_back({at, size});
      J.push_back(random_rows(r.random, r.random.integer(0, size), n, 3));
      M.middleRows(row, J.back().rows) = dense(J.back(), n);
      row += J.back().rows;
      rows += J.back().rows;
      at += size;
    }
    M.conservativeResize(row, n);
    const Dense expected = M * dense(r.P) * M.transpose();
    Thin X(rows, n);
    std::vector<Scalar> S(static_cast<std::size_t>(rows) * rows);
    kernels.transform_many(r.P, blocks.data(), views(J).data(), static_cast<int>(J.size()), X.data(), X.ld, S.data(),
                           rows);
    TEST_ASSERT_EQUAL_INT(row, r.P.n);
    assert_near(expected, dense(r.P));
    assert_padding_is_finite(r.P);
  }
}

void test_remove_should_keep_the_other_rows_bit_for_bit_when_several_segments_go() {
  for (int i = 0; i < kRounds; ++i) {
    Round r(i);
    const Dense before = dense(r.P);
    std::vector<Segment> gone;
    std::vector<int> kept;
    for (int at = 0; at < r.P.n;) {
      const int size = std::min(r.random.integer(1, 9), r.P.n - at);
      const bool go = r.random.integer(0, 2) == 0;
      if (go) gone.push_back({at, size});
      for (int j = at; j < at + size && !go; ++j) kept.push_back(j);
      at += size;
    }
    kernels.remove(r.P, gone.data(), static_cast<int>(gone.size()));
    TEST_ASSERT_EQUAL_INT(static_cast<int>(kept.size()), r.P.n);
    for (int a = 0; a < r.P.n; ++a) {
      for (int b = 0; b <= a; ++b) TEST_ASSERT_SAME(static_cast<double>(r.P(a, b)), before(kept[a], kept[b]));
    }
    assert_padding_is_finite(r.P);
  }
}

}  // namespace

void setUp(void) {}
void tearDown(void) {}

int main() {
  std::printf("seed %llu\n", static_cast<unsigned long long>(kSeed));
  UNITY_BEGIN();
  RUN_TEST(test_triangle_should_address_every_element_once_when_packed);
  RUN_TEST(test_gather_should_equal_the_dense_product_when_blocks_are_random);
  RUN_TEST(test_gather_many_should_stack_the_single_gathers_when_given_a_list);
  RUN_TEST(test_cholesky_and_solve_should_invert_the_product_when_positive_definite);
  RUN_TEST(test_cholesky_should_refuse_when_a_pivot_is_not_positive);
  RUN_TEST(test_downdate_should_equal_the_dense_formula_when_rows_are_considered_and_transported);
  RUN_TEST(test_predict_should_equal_the_dense_formula_when_the_leading_block_moves);
  RUN_TEST(test_augment_should_append_the_dense_product_when_n_is_no_multiple_of_eight);
  RUN_TEST(test_augment_should_begin_a_state_when_the_triangle_is_empty);
  RUN_TEST(test_transform_should_equal_the_dense_map_when_the_block_shrinks);
  RUN_TEST(test_replace_should_leave_the_gap_for_one_removal_when_many_blocks_shrink);
  RUN_TEST(test_transform_many_should_equal_the_dense_map_when_blocks_shrink_and_go);
  RUN_TEST(test_remove_should_keep_the_other_rows_bit_for_bit_when_several_segments_go);
  return UNITY_END();
}
