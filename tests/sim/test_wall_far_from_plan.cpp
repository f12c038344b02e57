// A wall that the plan has a standard deviation from its place, on rendered frames of one textured wall, beside one that is where the
// plan has it. The first patch moves it by a tenth or more of its distance: what the linearisation leaves out must not count as known.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <vector>

#include "support/wall_walk.h"

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr int kFrames = 150, kPatches = 8;
constexpr double kTurn = 0.05, kOffset = 0.08;  // of the plan's wall [rad], [m]
constexpr double kGate = 16.3;                  // chi-square of three degrees of freedom, 0.999

/// Normalised error of the plane z = 0, seen from z < 0: theta about the plane's axes from its normal, delta from its own origin.
double chi2_of(const pf_plane_t& plane) {
  const double* R = plane.R_WP;
  const double e[3] = {-R[6], -R[7], -(-plane.p_WP[2])};
  double L[3][3] = {}, y[3], sum = 0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j <= i; ++j) {
      double s = plane.covariance[3 * i + j];
      for (int k = 0; k < j; ++k) s -= L[i][k] * L[j][k];
      L[i][j] = i == j ? std::sqrt(s) : s / L[j][j];
    }
    y[i] = e[i];
    for (int k = 0; k < i; ++k) y[i] -= L[i][k] * y[k];
    y[i] /= L[i][i];
    sum += y[i] * y[i];
  }
  return sum;
}

void test_wall_far_from_the_plan_should_be_found_without_refusing_its_patches() {
  for (const double sign : {1.0, -1.0}) {
    WallWalk run(kFrames, kPatches, 0);
    pf_wall_prior_t there = WallWalk::wall(0, 1.25), far = WallWalk::wall(sign * kTurn, 1.25);
    there.p_WP[0] = -1.3;
    there.covariance[0] = there.covariance[4] = there.covariance[8] = 1e-6;
    far.p_WP[0] = 1.3;
    far.p_WP[2] = -sign * kOffset;
    far.covariance[0] = far.covariance[4] = kTurn * kTurn;
    far.covariance[8] = kOffset * kOffset;
    run.add(there);
    const std::uint32_t id = run.add(far);
    int measured = 0, refused = 0;
    double worst = 0;
    for (int frame = 0; frame < kFrames; ++frame) {
      run.step();
      int now = 0;
      for (const pf_patch_t& p : run.patches()) {
        if (p.plane != id) continue;
        now += p.status == PF_MATCH_INLIER;
        refused += p.status == PF_MATCH_OUTLIER;
      }
      measured += now;
      if (now == 0) continue;
      pf_plane_t planes[16];
      std::size_t count;
      TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_planes(run.slam, planes, 16, &count));
      for (std::size_t i = 0; i < count; ++i)
        if (planes[i].id == id) {
          if (measured < 12)
            std::printf("frame %d: chi2 %.1f, z of the normal %.4f\n", frame, chi2_of(planes[i]),
                        planes[i].normal_W[2]);
          worst = std::max(worst, chi2_of(planes[i]));
        }
    }
    std::printf("%d measurements on the wall, %d refused, worst chi-square of the wall %.1f, error %.4f m\n", measured,
                refused, worst, run.error_m);
    TEST_ASSERT_TRUE(measured > kFrames / 4);
    TEST_ASSERT_EQUAL_INT(0, refused);
    TEST_ASSERT_TRUE(worst < kGate);
  }
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_wall_far_from_the_plan_should_be_found_without_refusing_its_patches);
  return UNITY_END();
}
