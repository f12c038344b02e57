// How far parts of the map have drifted against each other, and how a return is spread: against least squares over all keyframes at once.
#include <unity.h>

#include <cmath>

#include "dense.h"
#include "keyframe_slam/loops/drift_chain.h"
#include "support/seeded_random.h"
#include "support/textured_images.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr int kSteps = 6, kPlace = 1;
constexpr double kTight = sizeof(Scalar) == 4 ? 1e-4 : 1e-8;

MapDrift random_drift(SeededRandom& random, double sigma) {
  MapDrift drift;
  drift.any = true;
  Mat6 A;
  for (int i = 0; i < 6; ++i) A.col(i) = random.normals<6>(sigma);
  drift.Q = A * A.transpose() + Mat6::Identity() * static_cast<Scalar>(sigma * sigma);
  drift.sigma_scale = static_cast<Scalar>(sigma * random.uniform(0.5, 1.5));
  return drift;
}

/// The place, with number 1, and keyframes 2 to 7 on the way away from it and back.
struct Bench {
  SeededRandom random{31};
  TestArena arena;
  DriftChain chain;
  SimilarityCovariance Q[kSteps];  ///< of each step, about the origin
  Vec3 at_W[kSteps];

  explicit Bench(int room = 16) {
    TEST_ASSERT_TRUE(chain.layout(*arena, room));
    chain.init();
    chain.add(kPlace, 0, MapDrift(), Vec3::Zero());
    for (int i = 0; i < kSteps; ++i) {
      at_W[i] = random.normals<3>(2);
      const SimilarityCovariance before = chain.sum();
      chain.add(kPlace + 1 + i, 0, random_drift(random, 0.01), at_W[i]);
      Q[i] = chain.sum() - before;
    }
  }
  LoopClosure loop() {
    LoopClosure out;
    out.place = kPlace;
    out.at_W = at_W[kSteps - 1];
    out.prior = similarity_covariance_at(out.at_W, chain.between(kPlace, *chain.sum_of(kPlace), chain.sum()));
    return out;
  }
};

double worst_of(const Similarity& a, const Similarity& b) {
  return std::max({static_cast<double>((a.t - b.t).norm()), static_cast<double>(a.q.angularDistance(b.q)),
                   static_cast<double>(std::abs(a.s - b.s))});
}

/// Unknowns x_1 .. x_n, errors about the origin: steps x_i - x_(i-1) of covariance Q_i, and x_n measured with R.
void test_a_return_should_be_spread_as_by_least_squares() {
  Bench bench;
  LoopClosure loop = bench.loop();
  SimilarityCovariance R = SimilarityCovariance::Identity() * 1e-5;
  SimilarityError z;
  for (int i = 0; i < 7; ++i) z(i) = 1e-3 * bench.random.normal();
  const SimilarityCovariance K = loop.prior * inverse_of(loop.prior + R);
  loop.x = K * z;
  loop.posterior = loop.prior - K * loop.prior;

  constexpr int n = 7 * kSteps;
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(n);
  for (int i = 0; i < kSteps; ++i) {
    const SimilarityCovariance W = inverse_of(bench.Q[i]);
    A.block<7, 7>(7 * i, 7 * i) += W;
    if (i == 0) continue;
    A.block<7, 7>(7 * i - 7, 7 * i - 7) += W;
    A.block<7, 7>(7 * i, 7 * i - 7) -= W;
    A.block<7, 7>(7 * i - 7, 7 * i) -= W;
  }
  const SimilarityCovariance J = similarity_error_at(loop.at_W);
  const SimilarityCovariance of_R = J.transpose() * inverse_of(R);
  A.bottomRightCorner<7, 7>() += of_R * J;
  b.tail<7>() = of_R * z;
  const Eigen::MatrixXd P = inverse_of(A);
  const Eigen::VectorXd x = P * b;

  DriftSpread spread;
  TEST_ASSERT_TRUE(spread.begin(bench.chain, loop));
  for (int i = 0; i < kSteps; ++i) {
    const int number = kPlace + 1 + i;
    SimilarityCovariance sum = *bench.chain.sum_of(number);
    const Similarity T = spread.move(number, &sum);
    const SimilarityError at_camera = J * x.segment<7>(7 * i);
    TEST_ASSERT_TRUE(worst_of(T, similarity_of(at_camera, loop.at_W)) < kTight);
    const SimilarityCovariance expected = P.block<7, 7>(7 * i, 7 * i);
    TEST_ASSERT_TRUE((sum - *bench.chain.sum_of(kPlace) - expected).norm() < kTight * expected.norm());
  }
  SimilarityCovariance whole;
  TEST_ASSERT_TRUE(worst_of(spread.move_whole(&whole), similarity_of(loop.x, loop.at_W)) < kTight);
  SimilarityCovariance of_place = *bench.chain.sum_of(kPlace);
  TEST_ASSERT_TRUE(worst_of(spread.move(kPlace, &of_place), Similarity()) < kTight);
}

/// Whether its last keyframe or its first is the place, a walk drifts the same; and a world that is moved drifts as the old one did.
void test_drift_should_not_depend_on_where_the_world_is() {
  Bench bench, moved;
  const Similarity T = {exp_so3(Vec3(Scalar(0.3), Scalar(-0.2), 1)), Vec3(1, -2, Scalar(0.5)), Scalar(1.7)};
  moved.chain.move(T);
  const LoopClosure loop = bench.loop();
  const SimilarityCovariance now = similarity_covariance_at(
      T.of(loop.at_W), moved.chain.between(kPlace, *moved.chain.sum_of(kPlace), moved.chain.sum()));
  SimilarityCovariance A = SimilarityCovariance::Identity();
  A.block<3, 3>(0, 0) = T.q.toRotationMatrix().cast<double>();
  A.block<3, 3>(3, 3) = static_cast<double>(T.s) * A.block<3, 3>(0, 0);
  const SimilarityCovariance expected = A * loop.prior * A.transpose();
  TEST_ASSERT_TRUE((now - expected).norm() < kTight * expected.norm());
}

void test_after_a_return_the_chain_should_go_on_from_the_place() {
  Bench bench;
  const SimilarityCovariance known = SimilarityCovariance::Identity() * 1e-6, at_place = *bench.chain.sum_of(kPlace);
  const SimilarityCovariance middle = *bench.chain.sum_of(4);
  bench.chain.close(kPlace, at_place, known);
  TEST_ASSERT_TRUE((bench.chain.sum() - at_place - known).norm() < 1e-12);
  // Both ways around: from the middle back to the place, and from there here.
  const SimilarityCovariance between = bench.chain.between(4, middle, bench.chain.sum());
  TEST_ASSERT_TRUE((between - (middle - at_place) - known).norm() < 1e-12);
  TEST_ASSERT_EQUAL_INT(7, bench.chain.left_at(4));
}

/// A camera that was lost, and found at an old part of the map, has not drifted against that.
void test_a_keyframe_that_hangs_on_an_older_one_should_go_on_from_there() {
  Bench bench;
  const SimilarityCovariance third = *bench.chain.sum_of(3);
  const int breaks = bench.chain.breaks();
  bench.chain.add(8, 7, MapDrift(), Vec3::Zero());
  TEST_ASSERT_EQUAL_INT(breaks, bench.chain.breaks());
  bench.chain.add(9, 3, MapDrift(), Vec3::Zero());
  TEST_ASSERT_EQUAL_INT(breaks + 1, bench.chain.breaks());
  TEST_ASSERT_TRUE((bench.chain.sum() - third).norm() < 1e-12);
  TEST_ASSERT_EQUAL_INT(8, bench.chain.left_at(5));
}

void test_what_is_gone_should_make_room() {
  Bench bench(kSteps + 1);
  TEST_ASSERT_NOT_NULL(bench.chain.sum_of(2));
  bench.chain.keep_only([](int number) { return number > 2; });
  TEST_ASSERT_NULL(bench.chain.sum_of(2));
  bench.chain.add(8, 0, MapDrift(), Vec3::Zero());
  TEST_ASSERT_NOT_NULL(bench.chain.sum_of(8));
}

void test_without_room_no_drift_should_be_known() {
  DriftChain chain;
  TestArena arena;
  TEST_ASSERT_TRUE(chain.layout(*arena, 0));
  chain.init();
  SeededRandom random(3);
  chain.add(1, 0, random_drift(random, 0.01), Vec3::Zero());
  TEST_ASSERT_NULL(chain.sum_of(1));
  DriftSpread spread;
  LoopClosure loop;
  loop.place = 1;
  TEST_ASSERT_FALSE(spread.begin(chain, loop));
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_a_return_should_be_spread_as_by_least_squares);
  RUN_TEST(test_drift_should_not_depend_on_where_the_world_is);
  RUN_TEST(test_after_a_return_the_chain_should_go_on_from_the_place);
  RUN_TEST(test_a_keyframe_that_hangs_on_an_older_one_should_go_on_from_there);
  RUN_TEST(test_what_is_gone_should_make_room);
  RUN_TEST(test_without_room_no_drift_should_be_known);
  return UNITY_END();
}
