// The paper's filter in pf-sim: its operations on one triangle equal the plain matrix formulas.
#include "base/eigen.h"
// The program's source comes after the library's door to Eigen, which sets it up, and is taken in whole.
#include "../../tools/pf-sim/gee2007/ekf.cpp"
#include "same.h"
#include "support/seeded_random.h"
#include "unity.h"

using namespace pfsim::gee;

void setUp(void) {}
void tearDown(void) {}

namespace {

MatX draw(pf::SeededRandom& random, int rows, int columns) {
  MatX m(rows, columns);
  for (int c = 0; c < columns; ++c)
    for (int r = 0; r < rows; ++r) m(r, c) = random.normal();
  return m;
}

const int kSizes[4] = {7, 6, 3, 3};

/// Four blocks that are all correlated.
struct Filled {
  Ekf ekf{60};
  int block[4];

  explicit Filled(pf::SeededRandom& random) {
    for (int b = 0; b < 4; ++b) {
      std::vector<Touch> J;
      for (int k = 0; k < b; ++k) J.push_back({block[k], draw(random, kSizes[b], kSizes[k])});
      const MatX root = draw(random, kSizes[b], kSizes[b]);
      block[b] = ekf.augment(draw(random, kSizes[b], 1), J, root * root.transpose());
    }
  }

  MatX dense() const {
    MatX P(19, 19);
    for (int a = 0, at = 0; a < 4; at += kSizes[a++])
      for (int b = 0, to = 0; b < 4; to += kSizes[b++])
        P.block(at, to, kSizes[a], kSizes[b]) = ekf.covariance(block[a], block[b]);
    return P;
  }
};

void assert_equal(const MatX& a, const MatX& b) {
  TEST_ASSERT_SAME(b.rows(), a.rows());
  TEST_ASSERT_SAME(b.cols(), a.cols());
  TEST_ASSERT_TRUE((a - b).cwiseAbs().maxCoeff() < 1e-9 * (1 + b.cwiseAbs().maxCoeff()));
}

void test_update_should_equal_the_plain_formula() {
  pf::SeededRandom random(81);
  Filled f(random);
  const MatX P = f.dense();
  VecX x(19);
  x << f.ekf.value(f.block[0]), f.ekf.value(f.block[1]), f.ekf.value(f.block[2]), f.ekf.value(f.block[3]);
  MatX H = MatX::Zero(6, 19);
  const MatX camera = draw(random, 6, 7), a = draw(random, 2, 6), b = draw(random, 2, 3), c = draw(random, 2, 3);
  const VecX r = draw(random, 6, 1);
  H.leftCols(7) = camera;
  H.block(0, 7, 2, 6) = a;
  H.block(2, 13, 2, 3) = b;
  H.block(4, 7, 2, 6) = a;
  H.block(4, 16, 2, 3) = c;
  std::vector<Innovation> innovations = {
      {r.head<2>(), {{f.block[0], camera.topRows(2)}, {f.block[1], a}}},
      {r.segment<2>(2), {{f.block[0], camera.middleRows(2, 2)}, {f.block[2], b}}},
      {r.tail<2>(), {{f.block[3], c}, {f.block[0], camera.bottomRows(2)}, {f.block[1], a}}}};
  TEST_ASSERT_TRUE(f.ekf.update(innovations, 0.7));
  const MatX S = H * P * H.transpose() + 0.7 * MatX::Identity(6, 6), K = P * H.transpose() * S.inverse();
  assert_equal(f.dense(), P - K * S * K.transpose());
  VecX after(19);
  after << f.ekf.value(f.block[0]), f.ekf.value(f.block[1]), f.ekf.value(f.block[2]), f.ekf.value(f.block[3]);
  assert_equal(after, x + K * r);
}

void test_update_should_change_nothing_when_a_residual_is_no_number() {
  pf::SeededRandom random(82);
  Filled f(random);
  const MatX P = f.dense();
  TEST_ASSERT_FALSE(f.ekf.update({{Vec2(std::nan(""), 0), {{f.block[0], draw(random, 2, 7)}}}}, 1));
  TEST_ASSERT_SAME(P, f.dense());
}

void test_transform_should_equal_the_plain_formula_when_the_block_lies_between_others() {
  pf::SeededRandom random(83);
  Filled f(random);
  const MatX P = f.dense(), J_own = draw(random, 3, 6), J_other = draw(random, 3, 3);
  const VecX value = draw(random, 3, 1), last = f.ekf.value(f.block[3]);
  f.block[1] = f.ekf.transform(f.block[1], value, {{f.block[1], J_own}, {f.block[3], J_other}});
  MatX J = MatX::Zero(16, 19);
  J.block(0, 0, 7, 7).setIdentity();
  J.block(7, 7, 3, 6) = J_own;
  J.block(7, 16, 3, 3) = J_other;
  J.block(10, 13, 6, 6).setIdentity();
  const MatX expected = J * P * J.transpose();
  MatX got(16, 16);
  const int sizes[4] = {7, 3, 3, 3};
  for (int a = 0, at = 0; a < 4; at += sizes[a++])
    for (int b = 0, to = 0; b < 4; to += sizes[b++])
      got.block(at, to, sizes[a], sizes[b]) = f.ekf.covariance(f.block[a], f.block[b]);
  assert_equal(got, expected);
  TEST_ASSERT_EQUAL_INT(16, f.ekf.dimension());
  TEST_ASSERT_SAME(value, f.ekf.value(f.block[1]));
  TEST_ASSERT_SAME(last, f.ekf.value(f.block[3]));
}

void test_map_first_should_equal_the_plain_formula() {
  pf::SeededRandom random(84);
  Filled f(random);
  const MatX P = f.dense(), J = draw(random, 7, 7), Q = draw(random, 7, 7);
  f.ekf.map_first(J);
  f.ekf.add_noise(f.block[0], Q * Q.transpose());
  MatX all = MatX::Identity(19, 19), noise = MatX::Zero(19, 19);
  all.topLeftCorner(7, 7) = J;
  noise.topLeftCorner(7, 7) = Q * Q.transpose();
  assert_equal(f.dense(), all * P * all.transpose() + noise);
  TEST_ASSERT_TRUE(std::abs(f.ekf.sigma(f.block[2], 1) - std::sqrt(P(14, 14))) < 1e-12);
}

void test_augment_should_refuse_when_there_is_no_room() {
  pf::SeededRandom random(85);
  Filled f(random);
  TEST_ASSERT_EQUAL_INT(-1, f.ekf.augment(VecX::Zero(42), {}, MatX::Zero(42, 42)));
  TEST_ASSERT_EQUAL_INT(19, f.ekf.dimension());
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_update_should_equal_the_plain_formula);
  RUN_TEST(test_update_should_change_nothing_when_a_residual_is_no_number);
  RUN_TEST(test_transform_should_equal_the_plain_formula_when_the_block_lies_between_others);
  RUN_TEST(test_map_first_should_equal_the_plain_formula);
  RUN_TEST(test_augment_should_refuse_when_there_is_no_room);
  return UNITY_END();
}
