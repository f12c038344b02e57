// What a frame moves is one similarity, in the order in which it was moved.
#include <unity.h>

#include "frame/frame.h"
#include "geometry/so3.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr Scalar kTight = sizeof(Scalar) == 4 ? Scalar(1e-5) : Scalar(1e-12);

Similarity some(Scalar a, Scalar s) {
  return {exp_so3(Vec3(a, Scalar(0.3) - a, Scalar(0.1))), Vec3(1, a, -Scalar(0.5)), s};
}

void test_similarities_should_follow_each_other() {
  const Similarity first = some(Scalar(0.2), Scalar(1.3)), then = some(Scalar(-0.7), Scalar(0.6));
  const Vec3 p(Scalar(0.4), -1, 2);
  const Similarity both = then.after(first);
  TEST_ASSERT_TRUE((both.of(p) - then.of(first.of(p))).norm() < kTight);
  TEST_ASSERT_TRUE(both.q.angularDistance(then.q * first.q) < kTight);
  TEST_ASSERT_TRUE(std::abs(both.s - then.s * first.s) < kTight);
}

void test_a_similarity_between_two_poses_should_take_one_to_the_other() {
  const Quat q_0 = exp_so3(Vec3(1, -1, Scalar(0.2))), q_1 = exp_so3(Vec3(Scalar(0.3), 2, 0));
  const Vec3 p_0(1, 2, 3), p_1(-1, 0, Scalar(0.5));
  const Similarity T = Similarity::between(q_0, p_0, q_1, p_1);
  TEST_ASSERT_TRUE((T.of(p_0) - p_1).norm() < kTight);
  TEST_ASSERT_TRUE((T.q * q_0).angularDistance(q_1) < kTight * 10);
  TEST_ASSERT_TRUE(T.s >= 1 && T.s <= 1);
}

/// To the last bit: only what has moved is told.
void test_poses_that_are_the_same_should_give_the_identity() {
  const Quat q = exp_so3(Vec3(1, -1, Scalar(0.2)));
  const Similarity T = Similarity::between(q, Vec3(1, 2, 3), q, Vec3(1, 2, 3));
  TEST_ASSERT_TRUE(T.q.coeffs() == Quat::Identity().coeffs() && T.t == Vec3::Zero());
  MapCorrection correction;
  correction.add(T);
  correction.add(Similarity());
  TEST_ASSERT_TRUE(correction.T.q.coeffs() == Quat::Identity().coeffs() && correction.T.t == Vec3::Zero());
}

void test_a_frame_should_begin_without_and_keep_it_when_it_is_measured_again() {
  Frame frame;
  frame.init();
  frame.begin(1);
  frame.correction.add(some(Scalar(0.2), Scalar(1.3)));
  frame.correction.add(some(Scalar(0.1), Scalar(2)));
  frame.correction.rename(4);
  frame.correction.rename(5);
  frame.begin_again();
  TEST_ASSERT_TRUE(std::abs(frame.correction.T.s - Scalar(2.6)) < kTight);
  TEST_ASSERT_EQUAL_UINT32(4, frame.correction.from_map_id);
  frame.begin(2);
  TEST_ASSERT_TRUE(frame.correction.T.s <= 1 && frame.correction.T.s >= 1);
  TEST_ASSERT_EQUAL_UINT32(0, frame.correction.from_map_id);
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_similarities_should_follow_each_other);
  RUN_TEST(test_a_similarity_between_two_poses_should_take_one_to_the_other);
  RUN_TEST(test_poses_that_are_the_same_should_give_the_identity);
  RUN_TEST(test_a_frame_should_begin_without_and_keep_it_when_it_is_measured_again);
  return UNITY_END();
}
