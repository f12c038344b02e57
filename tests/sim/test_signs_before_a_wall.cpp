// Signs that hang before a wall of the plan, on rendered frames: patches begin on them, since they have more texture than the wall. They
// must not deny a wall that is there, and where the plan alone tells how far it is, they must not be taken for it.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <vector>

#include "planefold/planefold.h"
#include "sim/render.h"
#include "sim/scene_builder.h"
#include "unity.h"

using namespace pf::sim;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr int kFrames = 90, kSide = 64;
constexpr double kFrom = 3.0, kRate = 30, kSpeed = 0.5;  // of the camera from the wall [m], [1/s], along it [m/s]
constexpr double kAhead = 0.35;                          // of the signs before the wall [m]
constexpr double kMiddle = 1.25;                         // of each wall of the plan, to the left and to the right [m]

Pose pose_at(double t) { return {Mat3{}, {kSpeed * t - 0.6, 0.03 * std::sin(2 * t), -kFrom}}; }

constexpr double kPoster = 0.42;  // side of a sign and of a poster [m]: one patch fits

/// A wall that goes on to both sides; before its right half signs, and on it posters: their middles.
Scene make_signs(const std::vector<Vec3>& signs, const std::vector<Vec3>& posters) {
  Random random(3, 1);
  Builder b(random, SceneOptions());
  b.add({-4, -2.5, 0}, {1, 0, 0}, {0, 1, 0}, 8, 5, 0.004, 120, [&](Canvas& c) { b.clutter(c, 0.12, 30); });
  const auto hang = [&](const Vec3& middle, double ahead, double contrast) {
    b.add({middle.x - kPoster / 2, middle.y - kPoster / 2, -ahead}, {1, 0, 0}, {0, 1, 0}, kPoster, kPoster, 0.003, 120,
          [&](Canvas& c) { b.clutter(c, 0.08, contrast); });
  };
  for (const Vec3& middle : signs) hang(middle, kAhead, 110);
  for (const Vec3& middle : posters) hang(middle, 0.001, 90);
  return std::move(b.scene);
}

/// A half of the wall, as the plan has it.
pf_wall_prior_t half_of(double x, double sigma_rad, double sigma_m) {
  pf_wall_prior_t prior = {};
  const double R[9] = {-1, 0, 0, 0, 1, 0, 0, 0, -1}, corner[4][2] = {{-1.2, -2}, {1.2, -2}, {1.2, 2}, {-1.2, 2}};
  std::copy(R, R + 9, prior.R_WP);
  prior.p_WP[0] = x;
  prior.outline_count = 4;
  std::copy(&corner[0][0], &corner[0][0] + 8, &prior.outline_P[0][0]);
  prior.covariance[0] = prior.covariance[4] = sigma_rad * sigma_rad;
  prior.covariance[8] = sigma_m * sigma_m;
  return prior;
}

/// Patches alone; the left half of the wall is known well, and tells where the camera is.
class Walk {
 public:
  Walk(const Scene& scene, double sigma_rad, double sigma_m) : scene_(scene) {
    pf_config_t config;
    pf_config_default(&config);
    config.camera = {PF_CAMERA_PINHOLE,  640, 480, 560, 560, 319.5, 239.5, {}, 0, PF_CAMERA_EXACT,
                     PF_TIMESTAMPS_REAL, 0,   0,   0,   {}};
    config.capacity.max_patches = 16;
    config.capacity.patch_side_px = kSide;
    config.map.features_in_view = 0;
    renderer_ = std::make_unique<Renderer>(config.camera, 1);
    pf_memory_t need;
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_memory_query(&config, &need));
    block_.reset(std::aligned_alloc(need.alignment, (need.bytes + need.alignment) / need.alignment * need.alignment));
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_create(&config, block_.get(), need.bytes, &slam_));
    pf_pose_t first = {};
    const Pose pose = pose_at(0);
    const double p[3] = {pose.p_WC.x, pose.p_WC.y, pose.p_WC.z};
    first.q_WC[0] = 1;
    std::copy(p, p + 3, first.p_WC);
    first.v_W[0] = kSpeed;
    double velocities[36] = {};
    for (int i = 0; i < 6; ++i) {
      first.covariance[7 * i] = 1e-6;
      velocities[7 * i] = 1e-2;
    }
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_start_from_pose(slam_, &first, velocities));
    const pf_wall_prior_t left = half_of(-kMiddle, 1e-3, 1e-3), right = half_of(kMiddle, sigma_rad, sigma_m);
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_add_wall(slam_, &left, &left_));
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_add_wall(slam_, &right, &right_));
  }

  void step(int frame) {
    const double t = frame / kRate;
    const Pose pose = pose_at(t);
    std::vector<float> sum(640 * 480);
    renderer_->render(scene_, {pose}, 1, sum);
    std::vector<std::uint8_t> grey(sum.size());
    for (std::size_t i = 0; i < sum.size(); ++i)
      grey[i] = static_cast<std::uint8_t>(
          std::lround(std::clamp(static_cast<double>(sum[i]) + 2 * random_.normal(), 0.0, 255.0)));
    const pf_image_t image{grey.data(), 640, 480, 640, std::llround(1e9 * t)};
    TEST_ASSERT_TRUE(pf_push_frame(slam_, &image) >= PF_OK);
    pf_pose_t now;
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_pose(slam_, &now));
    worst_m = std::max(worst_m, std::fabs(now.p_WC[0] - pose.p_WC.x));
    pf_plane_t planes[16];
    std::size_t count;
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_planes(slam_, planes, 16, &count));
    const auto* found = std::find_if(planes, planes + count, [&](const pf_plane_t& p) { return p.id == right_; });
    TEST_ASSERT_TRUE(found != planes + count);
    doubted += found->rejected != 0;
    wall_m = found->distance;
    pf_patch_t patches[32];
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_patches(slam_, patches, 32, &count));
    for (std::size_t i = 0; i < count; ++i) {
      const bool taken = patches[i].status == PF_MATCH_INLIER;
      if (patches[i].plane == right_) {
        refused += patches[i].status == PF_MATCH_OUTLIER;
        measured += taken;
      } else if (patches[i].plane != left_) {
        on_signs += taken;
      }
    }
  }

  int doubted = 0, measured = 0, refused = 0, on_signs = 0;
  double worst_m = 0, wall_m = 0;

 private:
  Scene scene_;
  Random random_{7, 2};
  std::unique_ptr<Renderer> renderer_;
  std::unique_ptr<void, void (*)(void*)> block_{nullptr, std::free};
  pf_slam_t* slam_ = nullptr;
  std::uint32_t left_ = 0, right_ = 0;
};

void test_a_wall_should_not_be_doubted_for_signs_before_it() {
  const Scene scene = make_signs({{0.5, -0.5, 0}, {0.8, 0.4, 0}, {1.4, -0.3, 0}},
                                 {{0.9, -0.9, 0}, {1.5, 0.8, 0}, {1.0, -0.1, 0}, {1.9, 0.2, 0}, {1.9, -0.8, 0}});
  Walk walk(scene, 0.01, 0.02);
  for (int frame = 0; frame < kFrames; ++frame) walk.step(frame);
  std::printf("signs before it: doubted in %d frames, %d measured, %d refused, worst error %.4f m\n", walk.doubted,
              walk.measured, walk.refused, walk.worst_m);
  TEST_ASSERT_EQUAL_INT(0, walk.doubted);
  TEST_ASSERT_TRUE(walk.measured > kFrames / 2);
}

void test_a_sign_should_not_be_taken_for_a_wall_that_the_plan_alone_tells() {
  Walk walk(make_signs({{0.75, 0, 0}}, {{0.5, -0.8, 0}, {1.0, 0.7, 0}}), 0.05, 0.3);
  for (int frame = 0; frame < kFrames; ++frame) walk.step(frame);
  std::printf("one sign: wall %.4f m off, doubted in %d frames, %d measured, worst error %.4f m\n", walk.wall_m,
              walk.doubted, walk.measured, walk.worst_m);
  TEST_ASSERT_EQUAL_INT(0, walk.doubted);
  TEST_ASSERT_TRUE(std::fabs(walk.wall_m) < 0.05);
}

/// A plane that a patch founds before a wall is nearer than the wall, and is measured.
void test_a_patch_on_a_sign_should_be_measured_before_the_wall_behind_it() {
  constexpr int kLong = 130;
  Walk walk(make_signs({{0.9, -0.3, 0}, {1.5, 0.4, 0}, {2.0, -0.3, 0}}, {}), 0.01, 0.02);
  for (int frame = 0; frame < kLong; ++frame) walk.step(frame);
  std::printf("signs with planes of their own: %d measured, doubted in %d frames, worst error %.4f m\n", walk.on_signs,
              walk.doubted, walk.worst_m);
  TEST_ASSERT_TRUE(walk.on_signs > 20);
  TEST_ASSERT_EQUAL_INT(0, walk.doubted);
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_a_wall_should_not_be_doubted_for_signs_before_it);
  RUN_TEST(test_a_sign_should_not_be_taken_for_a_wall_that_the_plan_alone_tells);
  RUN_TEST(test_a_patch_on_a_sign_should_be_measured_before_the_wall_behind_it);
  return UNITY_END();
}
