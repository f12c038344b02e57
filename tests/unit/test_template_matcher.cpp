// Templates that straddle two surfaces: what their masks learn, how they are found, and normals against a simplex search.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "planefold/planefold.h"
#include "same.h"
#include "support/bounds.h"
#include "support/template_scene.h"
#include "track/template_matcher.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

/// Follows a template while the camera moves sideways. How many frames found it.
int follow(TemplateScene& scene, int frames, Scalar step, double* worst_px) {
  int found = 0;
  for (int k = 1; k <= frames; ++k) {
    const Vec3 c_W(static_cast<Scalar>(k) * step, static_cast<Scalar>(k) * step / 4, 0);
    const TestImage image = scene.see(c_W);
    scene.tracker.begin_frame(image.view());
    scene.matcher.begin_frame();
    const SearchTask task = scene.task(c_W);
    const SearchOutcome outcome = scene.matcher.search(scene.tracker, task);
    if (!outcome.found) continue;
    ++found;
    *worst_px = std::max(*worst_px, static_cast<double>((outcome.pixel - task.predicted).norm()));
    scene.matcher.learn(scene.tracker, task, outcome.pixel, &scene.shape, scene.mask);
  }
  return found;
}

void test_mask_should_keep_the_pixels_of_the_plane() {
  double right = 0;
  constexpr int kTrials = 6;
  for (int trial = 0; trial < kTrials; ++trial) {
    TemplateScene scene(700 + static_cast<std::uint64_t>(trial));
    scene.rim = 83;  // 5 of 15 columns show what is behind
    scene.learn_first(MaskMode::kPartial);
    double worst = 0;
    EXPECT_NOT_BELOW(24, follow(scene, 30, Scalar(-0.006), &worst));
    EXPECT_BELOW(0.4, worst);
    for (int at = 0; at < 225; ++at)
      right += (scene.mask[at] >= kMaskUnknown) == (scene.shape.left + at % 15 < scene.rim);
  }
  EXPECT_NOT_BELOW(0.93, right / (225 * kTrials));
}

void test_whole_template_should_be_lost_where_the_mask_keeps_it() {
  int partial = 0, whole = 0;
  for (int trial = 0; trial < 4; ++trial) {
    double worst = 0;
    TemplateScene with(720 + static_cast<std::uint64_t>(trial)), without(720 + static_cast<std::uint64_t>(trial));
    with.rim = without.rim = 83;
    with.learn_first(MaskMode::kPartial);
    without.learn_first(MaskMode::kWhole);
    partial += follow(with, 30, Scalar(-0.006), &worst);
    whole += follow(without, 30, Scalar(-0.006), &worst);
    for (int at = 0; at < 225; ++at) TEST_ASSERT_EQUAL_INT(255, without.mask[at]);
  }
  EXPECT_NOT_BELOW(2 * whole, partial);
}

void test_light_should_not_matter() {
  TemplateScene scene(740);
  scene.learn_first(MaskMode::kPartial);
  const Vec3 c_W(Scalar(0.03), 0, 0);
  TestImage image = scene.see(c_W);
  for (std::uint8_t& grey : image.pixels) grey = static_cast<std::uint8_t>(0.6 * grey + 40);
  scene.tracker.begin_frame(image.view());
  const SearchTask task = scene.task(c_W);
  const SearchOutcome outcome = scene.matcher.search(scene.tracker, task);
  TEST_ASSERT_TRUE(outcome.found);
  EXPECT_BELOW(0.15, (outcome.pixel - task.predicted).norm());
  TEST_ASSERT_TRUE(scene.matcher.learn(scene.tracker, task, outcome.pixel, &scene.shape, scene.mask));
  EXPECT_NOT_BELOW(0.8 * 225, scene.shape.area);
}

/// Weighted squares of a slope, by the aligner's own reading.
struct Cost {
  TemplateScene& scene;
  PlaneAligner& aligner;
  const PlanePatch& patch;
  const std::uint8_t* mask;
  TemplateWarp warp;
  Vec2 pixel;

  double at(const Vec2& slope) const {
    PlaneStart start;
    Mat3 shift;
    const Mat3 H = warp.homography(slope);
    if (!anchored(scene.camera, warp, H, pixel, &shift)) return 1e9;
    start.H_CK = shift * H;
    float gain = 1;
    if (!aligner.compare(scene.tracker.pyramid(), scene.camera, patch, start, mask, &gain)) return 1e9;
    double sum = 0;
    const PlaneSamples& s = aligner.samples();
    for (int i = 0; i < s.count; ++i) sum += static_cast<double>(s.valid[i] * s.r[i] * s.r[i]);
    return sum;
  }
};

/// Nelder and Mead's simplex, as the paper uses it.
Vec2 simplex(const Cost& cost, const Vec2& start) {
  std::array<Vec2, 3> x = {start, start + Vec2(Scalar(0.2), 0), start + Vec2(0, Scalar(0.2))};
  std::array<double, 3> f;
  for (std::size_t i = 0; i < 3; ++i) f[i] = cost.at(x[i]);
  for (int step = 0; step < 80; ++step) {
    for (std::size_t i = 0; i < 2; ++i)
      for (std::size_t j = 0; j < 2; ++j)
        if (f[j] > f[j + 1]) std::swap(f[j], f[j + 1]), std::swap(x[j], x[j + 1]);
    const Vec2 middle = (x[0] + x[1]) / 2;
    const auto along = [&](double a) { return Vec2(middle + static_cast<Scalar>(a) * (x[2] - middle)); };
    const auto take = [&](const Vec2& to, double value) { x[2] = to, f[2] = value; };
    const Vec2 over = along(-1);
    const double at_over = cost.at(over);
    if (at_over < f[0]) {
      const Vec2 far = along(-2);
      const double at_far = cost.at(far);
      at_far < at_over ? take(far, at_far) : take(over, at_over);
    } else if (at_over < f[1]) {
      take(over, at_over);
    } else {
      const Vec2 in = along(at_over < f[2] ? -0.5 : 0.5);
      const double at_in = cost.at(in);
      if (at_in < std::min(at_over, f[2])) {
        take(in, at_in);
      } else {
        for (std::size_t i = 1; i < 3; ++i) x[i] = (x[0] + x[i]) / 2, f[i] = cost.at(x[i]);
      }
    }
  }
  return f[0] < f[1] && f[0] < f[2] ? x[0] : f[1] < f[2] ? x[1] : x[2];
}

/// A larger square than a template, so that slopes are well told: extracted as a patch, with its rim masked out.
struct NormalBed {
  TemplateScene scene;
  PlaneAligner aligner;
  PlanePatch patch;
  std::uint8_t mask[31 * 31];
  Vec3 c_W = Vec3(Scalar(-0.11), Scalar(0.08), Scalar(0.02));
  TemplateWarp warp;
  Vec2 pixel;
  TestImage now = TestImage(1, 1);  // the tracker looks into it

  NormalBed(std::uint64_t seed, const Vec2& slope, int masked) : scene(seed) {
    scene.near_slope = slope;
    scene.pixel = Vec2(80, 60);
    TEST_ASSERT_TRUE(aligner.layout(*scene.arena, 31 * 31));
    const TestImage first = scene.see(Vec3::Zero());
    TEST_ASSERT_TRUE(extract_plane_patch(first.view(), 64, 44, 33, &patch));
    patch.levels = 1;
    for (int i = 0; i < 31 * 31; ++i) mask[i] = i % 31 < masked ? 5 : 250;
    warp = scene.warp_to(c_W, scene.near_depth);
    warp.ray_0 = Vec2((80 - scene.camera.cx) / scene.camera.fx, (60 - scene.camera.cy) / scene.camera.fy);
    now = scene.see(c_W);
    scene.tracker.begin_frame(now.view());
    pixel = scene.through(warp.homography(slope), 80, 60);
  }
  bool measure(const Vec2& start, TemplateNormal* out) {
    return measure_slopes(scene.tracker.pyramid(), scene.camera, patch, mask, warp, start, pixel, &aligner, out);
  }
};

void test_normal_should_be_that_of_a_simplex_search() {
  for (int trial = 0; trial < 5; ++trial) {
    SeededRandom random(760 + static_cast<std::uint64_t>(trial));
    const Vec2 truth(static_cast<Scalar>(random.uniform(-0.4, 0.4)), static_cast<Scalar>(random.uniform(-0.4, 0.4)));
    NormalBed bed(770 + static_cast<std::uint64_t>(trial), truth, trial % 2 == 0 ? 0 : 10);
    TemplateNormal found;
    const Vec2 start = truth / 2;
    TEST_ASSERT_TRUE(bed.measure(start, &found));
    const Cost cost{bed.scene, bed.aligner, bed.patch, bed.mask, bed.warp, bed.pixel};
    const Vec2 by_simplex = simplex(cost, start);
    EXPECT_BELOW(0.03, (found.slope - by_simplex).norm());
    EXPECT_BELOW(0.08, (found.slope - truth).norm());
  }
}

void test_covariance_of_a_normal_should_not_be_too_small() {
  double nees = 0;
  constexpr int kTrials = 12;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Vec2 truth(Scalar(0.3), Scalar(-0.2));
    NormalBed bed(780 + static_cast<std::uint64_t>(trial), truth, 0);
    TemplateNormal found;
    TEST_ASSERT_TRUE(bed.measure(truth / 2, &found));
    const Vec2 e = found.slope - truth;
    nees += static_cast<double>(e.dot(found.covariance.inverse() * e)) / kTrials;
  }
  EXPECT_BELOW(3.0, nees);  // 2 expected; the least warp error is on the safe side
}

void test_normal_should_stay_where_it_is_not_observable() {
  NormalBed bed(795, Vec2(Scalar(0.3), 0), 0);
  bed.c_W = Vec3(Scalar(-0.002), 0, 0);
  bed.warp = bed.scene.warp_to(bed.c_W, bed.scene.near_depth);
  TemplateNormal untouched;
  untouched.slope = Vec2(7, 7);
  TEST_ASSERT_FALSE(bed.measure(Vec2::Zero(), &untouched));
  TEST_ASSERT_SAME(Vec2(7, 7), untouched.slope);
}

void test_mask_with_a_wrong_normal_should_come_back_with_the_right_one() {
  // A slanted surface that is taken to face the camera: parallax moves the rim, and the normal takes that up before the mask does.
  TemplateScene scene(799);
  scene.near_slope = Vec2(Scalar(0.6), 0);
  scene.learn_first(MaskMode::kPartial);
  double worst = 0;
  EXPECT_NOT_BELOW(24, follow(scene, 30, Scalar(0.008), &worst));
  TEST_ASSERT_TRUE(scene.shape.has_normal);
  TEST_ASSERT_FLOAT_WITHIN(0.3f, 0.6f, scene.shape.slope[0]);
  EXPECT_NOT_BELOW(0.85 * 225, scene.shape.area);
}

void test_smeared_template_should_be_found_and_keep_its_mask() {
  // Motion of five pixels during the exposure: residuals on the plane are then about sigma_plane. With a bound of 1 half are refused.
  pf_config_t config;
  pf_config_default(&config);
  constexpr int kTrials = 20;
  int found = 0;
  double area = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    TemplateScene scene(900 + static_cast<std::uint64_t>(trial));
    scene.learn_first(MaskMode::kPartial);
    scene.matcher.init(scene.camera, MaskMode::kPartial, static_cast<float>(config.map.max_misfit));
    double worst = 0;
    follow(scene, 6, Scalar(-0.006), &worst);
    const float before = scene.shape.area;
    const Vec3 c_W(Scalar(-0.03), 0, 0);
    const TestImage sharp = scene.see(c_W);
    const ImageView view = sharp.view();
    const TestImage smeared(TemplateScene::kWidth, TemplateScene::kHeight, [&](int x, int y) {
      double sum = 0;
      for (int k = -2; k <= 2; ++k) sum += *view.pixel(std::clamp(x + k, 0, TemplateScene::kWidth - 1), y);
      return sum / 5;
    });
    scene.tracker.begin_frame(smeared.view());
    scene.matcher.begin_frame();
    const SearchTask task = scene.task(c_W);
    const SearchOutcome outcome = scene.matcher.search(scene.tracker, task);
    if (!outcome.found) continue;
    ++found;
    scene.matcher.learn(scene.tracker, task, outcome.pixel, &scene.shape, scene.mask);
    area += static_cast<double>(scene.shape.area / before) / kTrials;
  }
  std::printf("found %d of %d, mean area kept %.3f\n", found, kTrials, area);
  EXPECT_NOT_BELOW(kTrials - 2, found);
  EXPECT_NOT_BELOW(0.85, area);
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_mask_should_keep_the_pixels_of_the_plane);
  RUN_TEST(test_whole_template_should_be_lost_where_the_mask_keeps_it);
  RUN_TEST(test_light_should_not_matter);
  RUN_TEST(test_normal_should_be_that_of_a_simplex_search);
  RUN_TEST(test_covariance_of_a_normal_should_not_be_too_small);
  RUN_TEST(test_normal_should_stay_where_it_is_not_observable);
  RUN_TEST(test_mask_with_a_wrong_normal_should_come_back_with_the_right_one);
  RUN_TEST(test_smeared_template_should_be_found_and_keep_its_mask);
  return UNITY_END();
}
