// Anchors by themselves: their ids, what holds them, how sure they are, and what becomes of them when that changes.
#include <cmath>

#include "geometry/so3.h"
#include "map/anchor_table.h"
#include "same.h"
#include "support/numeric_jacobian.h"
#include "support/seeded_random.h"
#include "support/textured_images.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr int kCapacity = 4;
constexpr Scalar kRounding = sizeof(Scalar) == sizeof(float) ? Scalar(1e-4) : Scalar(1e-10);

struct Bench {
  TestArena arena;
  AnchorTable table;
  SeededRandom random;

  explicit Bench(std::uint64_t seed) : random(seed) {
    TEST_ASSERT_TRUE(table.layout(*arena, kCapacity));
    table.init();
  }
  RelativePlace place() {
    const Vec3 turn = random.normals<3>(1);
    const Vec3 at = random.normals<3>(1);
    return {exp_so3(turn), at};
  }
  Mat6 covariance(double sigma) {
    Mat6 A;
    for (int i = 0; i < 6; ++i) A.col(i) = random.normals<6>(sigma);
    const Mat6 P = A * A.transpose();
    return (P + P.transpose()) / 2;
  }
  /// One that lies in front of its view, and faces it.
  Anchor anchor() {
    Anchor out;
    out.map_id = 1;
    out.place = 3;
    out.T_KV = place();
    out.T_VA = {upright_on(Vec3(Scalar(0.1), Scalar(0.2), -1).normalized()), Vec3(Scalar(0.2), Scalar(-0.1), 2)};
    out.between = covariance(0.01);
    out.beside = covariance(0.01);
    return out;
  }
  /// The plane through an anchor, across its third axis.
  AnchorPlane plane_through(const Anchor& anchor) {
    AnchorPlane out;
    out.frame = {anchor.T_WA.q.toRotationMatrix(), anchor.T_WA.p};
    const Mat3 A = covariance(0.01).topLeftCorner<3, 3>();
    out.covariance = A;
    return out;
  }
};

Scalar apart(const RelativePlace& a, const RelativePlace& b) {
  return (a.p - b.p).norm() + log_so3((a.q * b.q.conjugate()).normalized()).norm();
}

void test_ids_should_never_be_used_twice() {
  Bench bench(1);
  AnchorTable& table = bench.table;
  for (std::uint32_t id = 1; id <= kCapacity; ++id) {
    const int entry = table.find_free();
    TEST_ASSERT_TRUE(entry >= 0);
    TEST_ASSERT_EQUAL_UINT32(id, table.add(entry, bench.anchor()));
    TEST_ASSERT_EQUAL_INT(entry, table.entry_of(id));
  }
  TEST_ASSERT_EQUAL_INT(-1, table.find_free());
  TEST_ASSERT_EQUAL_INT(kCapacity, table.count());
  table.remove(table.entry_of(2));
  TEST_ASSERT_EQUAL_INT(-1, table.entry_of(2));
  TEST_ASSERT_EQUAL_INT(-1, table.entry_of(0));
  TEST_ASSERT_EQUAL_UINT32(kCapacity + 1, table.add(table.find_free(), bench.anchor()));
  table.init();
  TEST_ASSERT_EQUAL_INT(0, table.count());
  Anchor saved = bench.anchor();
  saved.id = 40;
  table.restore(table.find_free(), saved);
  TEST_ASSERT_EQUAL_UINT32(41, table.add(table.find_free(), bench.anchor()));
}

void test_an_anchor_should_follow_its_reference() {
  Bench bench(2);
  Anchor anchor = bench.anchor();
  const RelativePlace T_WK = bench.place(), moved = bench.place();
  place_by(T_WK, Mat6::Zero(), nullptr, &anchor);
  const RelativePlace T_KA = T_WK.inverse().of(anchor.T_WA);
  place_by(moved, Mat6::Zero(), nullptr, &anchor);
  TEST_ASSERT_TRUE(apart(moved.of(T_KA), anchor.T_WA) < kRounding);
}

/// Of 20,000 draws of reference, view and plane.
void test_the_covariance_should_be_that_of_all_that_holds_it() {
  for (const bool on_plane : {false, true}) {
    Bench bench(on_plane ? 3 : 4);
    Anchor anchor = bench.anchor();
    const RelativePlace T_WK = bench.place();
    const Mat6 P_K = bench.covariance(0.004);
    anchor.between = bench.covariance(0.004);
    anchor.beside = on_plane ? Mat6(Mat6::Zero()) : bench.covariance(0.004);
    place_by(T_WK, Mat6::Zero(), nullptr, &anchor);
    AnchorPlane plane = bench.plane_through(anchor);
    plane.covariance = bench.covariance(0.004).topLeftCorner<3, 3>();
    place_by(T_WK, P_K, on_plane ? &plane : nullptr, &anchor);
    const auto root = [](const auto& P) {
      using Matrix = std::decay_t<decltype(P)>;
      return Matrix(Eigen::LLT<Matrix>(P).matrixL());
    };
    const auto draw = [&](const Mat6& P) { return Vec6(root(P) * bench.random.normals<6>(1)); };
    const auto moved = [](const RelativePlace& T, const Vec6& e) {
      return RelativePlace{(exp_so3(e.head<3>()) * T.q).normalized(), T.p + e.tail<3>()};
    };
    constexpr int kDraws = 20000;
    Mat6 sum = Mat6::Zero();
    for (int k = 0; k < kDraws; ++k) {
      Anchor drawn = anchor;
      const RelativePlace T_WV = moved(moved(T_WK, draw(P_K)).of(anchor.T_KV), draw(anchor.between));
      drawn.T_KV = RelativePlace();
      AnchorPlane drawn_plane = plane;
      drawn_plane.x = root(plane.covariance) * bench.random.normals<3>(1);
      place_by(T_WV, Mat6::Zero(), on_plane ? &drawn_plane : nullptr, &drawn);
      Vec6 e;
      e << log_so3((drawn.T_WA.q * anchor.T_WA.q.conjugate()).normalized()), drawn.T_WA.p - anchor.T_WA.p;
      if (!on_plane) e += draw(anchor.beside);
      sum += e * e.transpose();
    }
    const Mat6 sampled = sum / Scalar(kDraws);
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 6; ++j) {
        const Scalar size = std::sqrt(anchor.covariance(i, i) * anchor.covariance(j, j));
        TEST_ASSERT_TRUE(std::abs(sampled(i, j) - anchor.covariance(i, j)) < Scalar(0.05) * size);
      }
  }
}

void test_another_reference_should_leave_it_where_it_is_and_no_surer() {
  Bench bench(5);
  Anchor anchor = bench.anchor();
  place_by(bench.place(), bench.covariance(0.01), nullptr, &anchor);
  const Anchor before = anchor;
  const RelativePlace other = bench.place();
  anchor.hold_by(9, other);
  place_by(other, bench.covariance(0.01), nullptr, &anchor);
  TEST_ASSERT_EQUAL_UINT32(9, anchor.place);
  TEST_ASSERT_TRUE(apart(before.T_WA, anchor.T_WA) < kRounding);
  for (int i = 0; i < 6; ++i) TEST_ASSERT_TRUE(anchor.covariance(i, i) > before.covariance(i, i));
  anchor.hold_by(0, RelativePlace());
  place_by(RelativePlace(), Mat6::Zero(), nullptr, &anchor);
  TEST_ASSERT_TRUE(apart(before.T_WA, anchor.T_WA) < kRounding);
}

void test_a_plane_that_is_gone_should_leave_it_where_it_was_last() {
  Bench bench(6);
  Anchor anchor = bench.anchor();
  const RelativePlace T_WK = bench.place();
  const Mat6 P_K = bench.covariance(0.01);
  place_by(T_WK, P_K, nullptr, &anchor);
  AnchorPlane plane = bench.plane_through(anchor);
  anchor.plane = 5;
  plane.x = Vec3(Scalar(0.02), Scalar(-0.03), Scalar(0.1));
  place_by(T_WK, P_K, &plane, &anchor);
  const Anchor before = anchor;
  anchor.leave_plane();
  place_by(T_WK, P_K, nullptr, &anchor);
  TEST_ASSERT_TRUE(before.is_on_plane && !anchor.is_on_plane);
  TEST_ASSERT_TRUE(apart(before.T_WA, anchor.T_WA) < kRounding);
  TEST_ASSERT_TRUE(anchor.covariance.trace() > before.covariance.trace() / 2);
  place_by(T_WK, P_K, &plane, &anchor);  // it was found again
  TEST_ASSERT_TRUE(anchor.is_on_plane && apart(before.T_WA, anchor.T_WA) < kRounding);
}

/// Nothing tells where on its ray it is.
void test_a_plane_that_its_ray_misses_should_leave_it_unsure() {
  Bench bench(7);
  Anchor anchor = bench.anchor();
  anchor.beside.setZero();
  place_by(RelativePlace(), Mat6::Zero(), nullptr, &anchor);
  AnchorPlane plane = bench.plane_through(anchor);
  plane.frame.o_W = anchor.T_WV.p - plane.frame.R_WP.col(2);
  anchor.plane = 5;
  plane.frame.o_W += Scalar(3) * (anchor.T_WV.p - anchor.T_WA.p);
  place_by(RelativePlace(), Mat6::Zero(), &plane, &anchor);
  TEST_ASSERT_TRUE(anchor.covariance(3, 3) >= anchor.T_VA.p.squaredNorm() && anchor.covariance(0, 0) >= 1);
}

void test_scaling_should_move_those_of_the_map_alone() {
  Bench bench(8);
  AnchorTable& table = bench.table;
  const RelativePlace T_WK = bench.place();
  const Mat6 P_K = bench.covariance(0.01);
  Anchor held = bench.anchor(), loose = bench.anchor(), of_before = bench.anchor();
  held.map_id = loose.map_id = 4;
  of_before.map_id = 2;
  for (Anchor* anchor : {&held, &loose, &of_before}) place_by(T_WK, P_K, nullptr, anchor);
  loose.hold_by(0, RelativePlace());
  for (const Anchor* anchor : {&held, &loose, &of_before}) table.add(table.find_free(), *anchor);
  const Scalar s = Scalar(1.7);
  const Vec3 pivot(Scalar(0.3), -1, 2);
  table.move(4, 5, Similarity::about(pivot, s));
  const auto scaled = [&](const Vec3& p_W) { return Vec3(pivot + s * (p_W - pivot)); };
  Mat6 P_scaled = P_K;
  P_scaled.bottomRows<3>() *= s;
  P_scaled.rightCols<3>() *= s;
  TEST_ASSERT_EQUAL_UINT32(5, table[0].map_id);
  TEST_ASSERT_EQUAL_UINT32(5, table[1].map_id);
  TEST_ASSERT_EQUAL_UINT32(2, table[2].map_id);
  TEST_ASSERT_TRUE(apart(of_before.T_WA, table[2].T_WA) == Scalar(0));
  for (const int i : {0, 1}) {
    const Anchor& before = i == 0 ? held : loose;
    TEST_ASSERT_TRUE((table[i].T_WA.p - scaled(before.T_WA.p)).norm() < kRounding);
    if (i == 0)
      place_by({T_WK.q, scaled(T_WK.p)}, P_scaled, nullptr, &table[i]);
    else
      place_by(RelativePlace(), Mat6::Zero(), nullptr, &table[i]);
    TEST_ASSERT_TRUE((table[i].T_WA.p - scaled(before.T_WA.p)).norm() < kRounding);
    TEST_ASSERT_TRUE(std::abs(table[i].covariance(5, 5) / (s * s * before.covariance(5, 5)) - 1) < Scalar(1e-3));
    TEST_ASSERT_TRUE(std::abs(table[i].covariance(1, 1) / before.covariance(1, 1) - 1) < Scalar(1e-3));
  }
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_ids_should_never_be_used_twice);
  RUN_TEST(test_an_anchor_should_follow_its_reference);
  RUN_TEST(test_the_covariance_should_be_that_of_all_that_holds_it);
  RUN_TEST(test_another_reference_should_leave_it_where_it_is_and_no_surer);
  RUN_TEST(test_a_plane_that_is_gone_should_leave_it_where_it_was_last);
  RUN_TEST(test_a_plane_that_its_ray_misses_should_leave_it_unsure);
  RUN_TEST(test_scaling_should_move_those_of_the_map_alone);
  return UNITY_END();
}
