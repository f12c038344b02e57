// Sub-pixel alignment of patches, and of whole coarse images over a rotation.
#include <cstring>
#include <limits>

#include "support/bounds.h"
#include "support/textured_images.h"
#include "unity.h"
#include "vision/align.h"
#include "vision/rotation_align.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

bool template_at(const ImageView& image, int x, int y, AlignTemplate* out) {
  float window[kWarpSize * kWarpSize];
  for (int j = 0; j < kWarpSize; ++j) {
    for (int i = 0; i < kWarpSize; ++i) {
      window[j * kWarpSize + i] = static_cast<float>(image.at(x - kWarpSize / 2 + i, y - kWarpSize / 2 + j));
    }
  }
  return make_align_template(window, out);
}

struct Outcome {
  int converged = 0, tried = 0;
  double rms_px = 0, worst_px = 0;
  double rms_grey = 0, least_zncc = 1, gain = 0, nees = 0;
};

/// Many places of one texture, shown again with a shift, gain, bias and noise in both images.
Outcome align_all(std::uint64_t seed, double gain, double bias, double sigma) {
  SeededRandom random(seed);
  const Texture texture(&random, 9, 40);
  Outcome out;
  for (int k = 0; k < 8; ++k) {
    const double dx = random.uniform(-1.4, 1.4), dy = random.uniform(-1.4, 1.4);
    const TestImage before(120, 120, [&](int x, int y) { return texture.at(x, y) + sigma * random.normal(); });
    const TestImage after(
        120, 120, [&](int x, int y) { return gain * texture.at(x - dx, y - dy) + bias + sigma * random.normal(); });
    for (int y = 12; y < 108; y += 9) {
      for (int x = 12; x < 108; x += 9) {
        AlignTemplate pattern;
        if (!template_at(before.view(), x, y, &pattern)) continue;
        ++out.tried;
        const AlignResult found = align(after.view(), pattern, Vec2(x, y));
        if (!found.converged) continue;
        ++out.converged;
        const double ex = static_cast<double>(found.position.x()) - x - dx;
        const double ey = static_cast<double>(found.position.y()) - y - dy;
        out.rms_px += ex * ex + ey * ey;
        out.worst_px = std::fmax(out.worst_px, std::hypot(ex, ey));
        out.rms_grey += static_cast<double>(found.rms * found.rms);
        out.least_zncc = std::fmin(out.least_zncc, static_cast<double>(found.zncc));
        out.gain += static_cast<double>(found.gain);
        const Eigen::Vector2d error(ex, ey);
        out.nees += error.dot(found.covariance().cast<double>().inverse() * error);
      }
    }
  }
  out.rms_px = std::sqrt(out.rms_px / out.converged);
  out.rms_grey = std::sqrt(out.rms_grey / out.converged);
  out.gain /= out.converged;
  out.nees /= out.converged;
  std::printf(
      "gain %g bias %g sigma %g: %d of %d converged, rms %.4f px, worst %.4f px, %.2f grey, zncc %.4f, nees %.2f\n",
      gain, bias, sigma, out.converged, out.tried, out.rms_px, out.worst_px, out.rms_grey, out.least_zncc, out.nees);
  return out;
}

void test_alignment_should_be_exact_to_a_fiftieth_pixel_when_there_is_no_noise() {
  const Outcome o = align_all(41, 1, 0, 0);
  TEST_ASSERT_GREATER_THAN_INT(o.tried * 98 / 100, o.converged);
  EXPECT_BELOW(0.02, o.rms_px);
  EXPECT_NOT_BELOW(0.99, o.least_zncc);
}

void test_alignment_should_be_good_to_a_tenth_pixel_when_noise_is_two_grey_levels() {
  const Outcome o = align_all(42, 1, 0, 2);
  TEST_ASSERT_GREATER_THAN_INT(o.tried * 97 / 100, o.converged);
  EXPECT_BELOW(0.1, o.rms_px);
  TEST_ASSERT_DOUBLE_WITHIN(0.3, 2 * std::sqrt(2.0), o.rms_grey);  // the noise of both images
}

void test_covariance_should_tell_the_error_when_noise_is_not_known() {
  for (const double sigma : {2.0, 3.0, 5.0}) {
    const Outcome o = align_all(43, 0.7, 20, sigma);
    TEST_ASSERT_DOUBLE_WITHIN(0.7, 2.0, o.nees);
  }
}

void test_alignment_should_not_care_when_gain_and_bias_change() {
  const Outcome o = align_all(44, 0.5, 60, 0);
  TEST_ASSERT_GREATER_THAN_INT(o.tried * 98 / 100, o.converged);
  EXPECT_BELOW(0.03, o.rms_px);
  TEST_ASSERT_DOUBLE_WITHIN(0.02, 0.5, o.gain);
}

void test_template_should_be_refused_when_it_has_no_corner() {
  AlignTemplate pattern;
  TEST_ASSERT_FALSE(template_at(TestImage(32, 32).view(), 16, 16, &pattern));
  const TestImage edge(32, 32, [](int x, int) { return 128 + 80 * std::sin(0.5 * x); });
  TEST_ASSERT_FALSE(template_at(edge.view(), 16, 16, &pattern));
}

void test_alignment_should_stay_near_its_start_when_something_else_is_there() {
  SeededRandom random(45);
  const TestImage before = noise_image(64, 64, &random);
  const TestImage after = noise_image(64, 64, &random);
  for (int k = 0; k < 200; ++k) {
    const int x = static_cast<int>(random.uniform(8, 56)), y = static_cast<int>(random.uniform(8, 56));
    AlignTemplate pattern;
    TEST_ASSERT_TRUE(template_at(before.view(), x, y, &pattern));
    const AlignResult found = align(after.view(), pattern, Vec2(x, y));
    TEST_ASSERT_LESS_OR_EQUAL_INT(kAlignMaxIterations, found.iterations);
    TEST_ASSERT_TRUE(std::fabs(static_cast<double>(found.position.x()) - x) <= static_cast<double>(kAlignReach));
    TEST_ASSERT_TRUE(std::fabs(static_cast<double>(found.position.y()) - y) <= static_cast<double>(kAlignReach));
    if (found.converged) EXPECT_BELOW(0.9f, found.zncc);
  }
}

void test_alignment_should_stay_in_the_image_when_the_start_is_anywhere() {
  SeededRandom random(46);
  const Texture texture(&random, 9, 30);
  const TestImage image(32, 32, [&](int x, int y) { return texture.at(x, y); });
  AlignTemplate pattern;
  TEST_ASSERT_TRUE(template_at(image.view(), 16, 16, &pattern));
  for (int y = -5; y < 38; ++y) {
    for (int x = -5; x < 38; ++x) {
      const Vec2 start(static_cast<Scalar>(x + 0.37), static_cast<Scalar>(y + 0.81));
      const AlignResult found = align(image.view(), pattern, start);
      const bool fits = x >= 5 && y >= 5 && x < 26 && y < 26;
      TEST_ASSERT_TRUE(fits || !found.converged);
    }
  }
  for (const int corner : {6, 25}) {  // 6: what the template's gradients leave free; the window reaches the last pixels
    TEST_ASSERT_TRUE(template_at(image.view(), corner, corner, &pattern));
    const AlignResult found = align(image.view(), pattern, Vec2(corner, corner));
    TEST_ASSERT_TRUE(found.converged);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, corner, static_cast<double>(found.position.x()));
  }
  const Scalar nan = std::numeric_limits<Scalar>::quiet_NaN();
  TEST_ASSERT_FALSE(align(image.view(), pattern, Vec2(nan, 16)).converged);
  TEST_ASSERT_FALSE(align(image.view(), pattern, Vec2(16, Scalar(1e20))).converged);
}

// ---- rotation ----

/// A texture painted on the directions; rays of the camera are turned by R before it is looked up.
TestImage view_of(const Texture& texture, const Eigen::Matrix3d& R, double gain, double bias) {
  return TestImage(80, 60, [&](int u, int v) {
    const Eigen::Vector3d ray = R * Eigen::Vector3d((u - 39.5) / 65, (v - 29.5) / 65, 1);
    return gain * texture.at(100 * ray.x() / ray.z(), 100 * ray.y() / ray.z()) + bias;
  });
}

void test_rotation_should_be_found_when_a_hand_turns_quickly() {
  SeededRandom random(47);
  const CoarseCamera camera{65, 65, 39.5f, 29.5f};
  int valid = 0;
  double worst = 0;
  for (int k = 0; k < 30; ++k) {
    const Texture texture(&random, 20, 120);
    const Eigen::Vector3d w(random.uniform(-0.07, 0.07), random.uniform(-0.07, 0.07), random.uniform(-0.1, 0.1));
    const Eigen::Matrix3d R = Eigen::AngleAxisd(w.norm(), w.normalized()).toRotationMatrix();
    TestArena arena;
    RotationAligner aligner;
    TEST_ASSERT_TRUE(aligner.layout(*arena, 80, 60));
    TEST_ASSERT_FALSE(
        aligner.update(view_of(texture, Eigen::Matrix3d::Identity(), 1, 0).view(), camera, Vec3::Zero()).valid);
    // A ray of the current camera, turned back by R transposed, is that of the previous one.
    const RotationEstimate e = aligner.update(view_of(texture, R.transpose(), 0.8, 25).view(), camera, Vec3::Zero());
    valid += e.valid ? 1 : 0;
    if (!e.valid) continue;
    EXPECT_BELOW(e.before, e.after);
    worst = std::fmax(worst, (e.rotation.cast<double>() - w).norm());
  }
  std::printf("rotation: %d of 30, worst %.5f rad\n", valid, worst);
  TEST_ASSERT_GREATER_OR_EQUAL_INT(28, valid);
  EXPECT_BELOW(0.005, worst);
}

void test_rotation_should_be_nothing_when_the_frame_is_the_same() {
  SeededRandom random(48);
  const Texture texture(&random, 20, 120);
  const TestImage image = view_of(texture, Eigen::Matrix3d::Identity(), 1, 0);
  TestArena arena;
  RotationAligner aligner;
  TEST_ASSERT_TRUE(aligner.layout(*arena, 80, 60));
  const CoarseCamera camera{65, 65, 39.5f, 29.5f};
  aligner.update(image.view(), camera, Vec3::Zero());
  const RotationEstimate e = aligner.update(image.view(), camera, Vec3::Zero());
  TEST_ASSERT_TRUE(e.valid);
  EXPECT_BELOW(1e-4, static_cast<double>(e.rotation.norm()));
  aligner.reset();
  TEST_ASSERT_FALSE(aligner.update(image.view(), camera, Vec3::Zero()).valid);
}

void test_rotation_should_not_depend_on_what_the_memory_held_when_it_was_full_of_nan() {
  SeededRandom random(50);
  const CoarseCamera camera{65, 65, 39.5f, 29.5f};
  const Texture texture(&random, 20, 120);
  const Eigen::Matrix3d R = Eigen::AngleAxisd(0.03, Eigen::Vector3d(0.6, 0, 0.8)).toRotationMatrix();
  RotationEstimate found[2];
  for (int k = 0; k < 2; ++k) {
    alignas(64) static std::uint8_t block[200000];
    std::memset(block, k == 0 ? 0 : 0xff, sizeof block);
    Arena arena(block, sizeof block);
    RotationAligner aligner;
    TEST_ASSERT_TRUE(aligner.layout(arena, 80, 60) && arena.ok());
    aligner.update(view_of(texture, Eigen::Matrix3d::Identity(), 1, 0).view(), camera, Vec3::Zero());
    found[k] = aligner.update(view_of(texture, R, 1, 0).view(), camera, Vec3::Zero());
#if defined(__SANITIZE_ADDRESS__)
    ASAN_UNPOISON_MEMORY_REGION(block, sizeof block);
#endif
  }
  TEST_ASSERT_TRUE(found[0].valid);
  TEST_ASSERT_TRUE(found[0].rotation == found[1].rotation);
}

void test_rotation_should_be_refused_when_images_say_nothing() {
  TestArena arena;
  RotationAligner aligner;
  TEST_ASSERT_TRUE(aligner.layout(*arena, 80, 60));
  const CoarseCamera camera{65, 65, 39.5f, 29.5f};
  const TestImage black(80, 60);
  aligner.update(black.view(), camera, Vec3::Zero());
  TEST_ASSERT_FALSE(aligner.update(black.view(), camera, Vec3::Zero()).valid);
  SeededRandom random(49);
  const Texture texture(&random, 20, 120);
  const TestImage image = view_of(texture, Eigen::Matrix3d::Identity(), 1, 0);
  TEST_ASSERT_FALSE(aligner.update(image.view(), camera, Vec3::Zero()).valid);
  const Scalar nan = std::numeric_limits<Scalar>::quiet_NaN();
  TEST_ASSERT_FALSE(aligner.update(image.view(), camera, Vec3(nan, 0, 0)).valid);
  TEST_ASSERT_FALSE(aligner.update(image.view(), CoarseCamera{0, 0, 0, 0}, Vec3::Zero()).valid);
  TEST_ASSERT_FALSE(aligner.update(TestImage(40, 30).view(), camera, Vec3::Zero()).valid);
  for (const int side : {1, 7, 8, 9, 32, 129, 1000}) {
    TestArena other;
    RotationAligner small;
    TEST_ASSERT_TRUE(small.layout(*other, side, 32));
    const TestImage noise = noise_image(side, 32, &random);
    small.update(noise.view(), camera, Vec3::Zero());
    small.update(noise.view(), camera, Vec3(Scalar(0.4), Scalar(-2), 1));
  }
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_alignment_should_be_exact_to_a_fiftieth_pixel_when_there_is_no_noise);
  RUN_TEST(test_alignment_should_be_good_to_a_tenth_pixel_when_noise_is_two_grey_levels);
  RUN_TEST(test_covariance_should_tell_the_error_when_noise_is_not_known);
  RUN_TEST(test_alignment_should_not_care_when_gain_and_bias_change);
  RUN_TEST(test_template_should_be_refused_when_it_has_no_corner);
  RUN_TEST(test_alignment_should_stay_near_its_start_when_something_else_is_there);
  RUN_TEST(test_alignment_should_stay_in_the_image_when_the_start_is_anywhere);
  RUN_TEST(test_rotation_should_be_found_when_a_hand_turns_quickly);
  RUN_TEST(test_rotation_should_be_nothing_when_the_frame_is_the_same);
  RUN_TEST(test_rotation_should_not_depend_on_what_the_memory_held_when_it_was_full_of_nan);
  RUN_TEST(test_rotation_should_be_refused_when_images_say_nothing);
  return UNITY_END();
}
