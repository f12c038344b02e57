// The warps of a patch on a plane: their 2xk Jacobians, and the rows that the aligner makes of them four at a time.
#include "support/numeric_jacobian.h"
#include "support/seeded_random.h"
#include "vision/plane_warps.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

template <typename Warp>
void check_warp(const Warp& warp, SeededRandom& random, const char* name) {
  for (int trial = 0; trial < 20; ++trial) {
    const Scalar X = static_cast<Scalar>(random.uniform(-1, 1)), Y = static_cast<Scalar>(random.uniform(-1, 1));
    const auto moved = [&](const typename Warp::Step& e) {
      const Vec3 p = warp.increment(e) * Vec3(X, Y, 1);
      return Vec2(p.x() / p.z(), p.y() / p.z());
    };
    const typename Warp::Jacobian J = warp.jacobian(X, Y);
    check_jacobian<2, Warp::kSize>(J, moved, name);

    const float gx = static_cast<float>(random.uniform(-9, 9)), gy = static_cast<float>(random.uniform(-9, 9));
    F32x4 rows[Warp::kSize];
    const F32x4 zero = {};
    warp.rows(zero + static_cast<float>(X), zero + static_cast<float>(Y), zero + gx, zero + gy, rows);
    for (int k = 0; k < Warp::kSize; ++k) {
      const double wanted = static_cast<double>(gx) * static_cast<double>(J(0, k)) +
                            static_cast<double>(gy) * static_cast<double>(J(1, k));
      TEST_ASSERT_DOUBLE_WITHIN(1e-4, wanted, static_cast<double>(rows[k][trial % 4]));
    }
  }
}

void test_shift_should_have_an_exact_jacobian() {
  SeededRandom random(611);
  check_warp(ShiftWarp(), random, "shift");
}

void test_slopes_should_have_an_exact_jacobian() {
  SeededRandom random(612);
  for (int k = 0; k < 5; ++k) {
    SlopesWarp warp;
    warp.t = random.normals<3>(0.2);
    Mat3 H = Mat3::Identity();
    for (int i = 0; i < 9; ++i) H(i / 3, i % 3) += static_cast<Scalar>(random.uniform(-0.1, 0.1));
    warp.begin(H);
    check_warp(warp, random, "slopes");
  }
}

void test_homography_should_have_an_exact_jacobian() {
  SeededRandom random(613);
  check_warp(HomographyWarp(), random, "homography");
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_shift_should_have_an_exact_jacobian);
  RUN_TEST(test_slopes_should_have_an_exact_jacobian);
  RUN_TEST(test_homography_should_have_an_exact_jacobian);
  return UNITY_END();
}
