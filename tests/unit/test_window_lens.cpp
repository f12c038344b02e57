// The lens in the adjustment of the window's keyframes: a wrong calibration is found out, and its covariance says how well.
#include <cmath>

#include "geometry/so3.h"
#include "keyframe_slam/map/rows.h"
#include "same.h"
#include "support/window_bench.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

/// The map begins with a lens that is as uncertain as this, and with keyframes that look about the same way.
void begin_with_lens(KeyframeBench* bench, TestArena* more, const LensSigmas& sigmas) {
  bench->settings.lens = make_lens_prior(sigmas, &bench->settings.camera);
  TEST_ASSERT_TRUE(bench->adjustment.layout(**more));
  bench->adjustment.init();
  bench->map.init();
  for (int k = 0; k < KeyframeBench::kKeyframes; ++k) {
    const Scalar s = static_cast<Scalar>(k);
    bench->map.keyframes.add(k, exp_so3(Vec3(Scalar(0.1) * std::sin(s), Scalar(0.05) * s, Scalar(0.2) * std::cos(s))),
                             Vec3(Scalar(0.1) * s, Scalar(0.05) * std::sin(s), Scalar(0.03) * s));
  }
}

/// Pixels of a camera with k1, about a calibration that names no distortion.
struct LensBench : KeyframeBench {
  static constexpr double kK1 = -0.06, kSigma = 0.3;  // [px]
  Camera truth;

  explicit LensBench(std::uint64_t seed, double sigma_k1) : KeyframeBench(seed) {
    LensSigmas sigmas;
    sigmas.focal = Scalar(0.01);
    sigmas.aspect = Scalar(0.001);
    sigmas.centre = Scalar(3);
    sigmas.distortion[0] = static_cast<Scalar>(sigma_k1);
    if (sigma_k1 > 0) begin_with_lens(this, &more, sigmas);
    truth = settings.camera;
    truth.model = static_cast<int>(CameraModel::kRadtan);
    truth.distortion[0] = Scalar(kK1);
    init_camera(&truth);
  }
  /// Points where the first keyframe looks, at their true depths.
  void fill() {
    for (int c = 0; c < kPoints; ++c) {
      const Vec2 pixel(static_cast<Scalar>(random.uniform(40, settings.camera.width - 40)),
                       static_cast<Scalar>(random.uniform(40, settings.camera.height - 40)));
      Vec3 ray;
      TEST_ASSERT_TRUE(unproject(truth, pixel, &ray));
      const Keyframe& host = map.keyframes[0];
      const Scalar depth = static_cast<Scalar>(random.uniform(1, 3));
      const Vec3 p_W = host.q_WC * ray * depth + host.p_W;
      const int i = map.add(0, pixel);
      TEST_ASSERT_TRUE(i >= 0);
      map.point(i).rho = 1 / depth;
      map.point(i).has_depth = true;
      tables.features[i].observations = 20;
      for (int k = 1; k < kKeyframes; ++k) {
        Vec2 z;
        const Keyframe& keyframe = map.keyframes[k];
        if (project(truth, keyframe.q_WC.conjugate() * (p_W - keyframe.p_W), &z))
          map.keyframes.set_pixel(k, i, z + random.normals<2>(kSigma));
      }
    }
  }
  TestArena more;
};

void test_a_distortion_that_the_calibration_lacks_should_be_found() {
  constexpr int kRuns = 12;
  double squares = 0;
  for (int run = 0; run < kRuns; ++run) {
    LensBench bench(static_cast<std::uint64_t>(10 + run), 0.05);
    bench.fill();
    for (int again = 0; again < 3; ++again) TEST_ASSERT_TRUE(bench.adjustment.run(true));
    const KeyframeLens& lens = bench.map.lens();
    const int n = lens.rows().count;
    TEST_ASSERT_EQUAL_INT(5, n);
    const double off = static_cast<double>(lens.camera().distortion[0]) - LensBench::kK1;
    const double variance = static_cast<double>(lens.covariance()[(n - 1) * (n + 1)]);
    TEST_ASSERT_TRUE(std::fabs(off) < 0.02);
    TEST_ASSERT_TRUE(variance < 0.01 * 0.01);
    squares += off * off / variance / kRuns;
  }
  std::printf("k1: mean of squared errors in sigmas %.2f\n", squares);
  TEST_ASSERT_TRUE(squares < 3);
}

void test_bearings_should_follow_the_lens_and_keep_their_pixels() {
  LensBench bench(3, 0.05);
  bench.fill();
  const HostPixel before = bench.map.host_pixel(7);
  const Vec3 ray = bench.map.point(7).ray_K;
  bench.map.move_lens(bench.truth);
  const HostPixel after = bench.map.host_pixel(7);
  TEST_ASSERT_TRUE(before.given && after.given);
  TEST_ASSERT_TRUE((after.pixel - before.pixel).norm() < Scalar(1e-2));
  TEST_ASSERT_TRUE((bench.map.point(7).ray_K - ray).norm() > Scalar(1e-5));
}

void test_a_point_of_the_target_should_not_follow_the_lens() {
  LensBench bench(4, 0.05);
  bench.fill();
  bench.tables.features[7].is_target = true;
  const Vec3 ray = bench.map.point(7).ray_K;
  bench.map.move_lens(bench.truth);
  TEST_ASSERT_SAME(ray, bench.map.point(7).ray_K);
}

void test_the_lens_should_stay_where_the_caller_does_not_want_it_adjusted() {
  LensBench bench(5, 0.05);
  bench.fill();
  TEST_ASSERT_TRUE(bench.adjustment.run(false));
  TEST_ASSERT_SAME(Scalar(0), bench.map.camera().distortion[0]);
  TEST_ASSERT_SAME(bench.settings.camera.fx, bench.map.camera().fx);
}

void test_a_new_map_should_begin_at_the_calibration() {
  LensBench bench(6, 0.05);
  bench.fill();
  TEST_ASSERT_TRUE(bench.adjustment.run(true));
  TEST_ASSERT_TRUE(bench.map.camera().distortion[0] != Scalar(0));
  bench.map.init();
  TEST_ASSERT_SAME(Scalar(0), bench.map.camera().distortion[0]);
  TEST_ASSERT_SAME(bench.settings.lens.covariance(4, 4), bench.map.lens().covariance()[24]);
}

/// Keyframes that move, and the pixels of a rolling shutter of which the calibration says nothing.
struct RowsBench : KeyframeBench {
  static constexpr double kReadout = 0.02, kSigma = 0.3;  // [s], [px]
  Camera truth;
  TestArena more;

  explicit RowsBench(std::uint64_t seed) : KeyframeBench(seed) {
    LensSigmas sigmas;
    sigmas.readout = Scalar(0.015);
    begin_with_lens(this, &more, sigmas);
    for (int k = 0; k < kKeyframes; ++k) {
      map.keyframes[k].v_W = random.normals<3>(0.3);
      map.keyframes[k].w_C = random.normals<3>(0.5);
    }
    truth = settings.camera;
    truth.readout = Scalar(kReadout);
  }
  Body body(int k) const {
    Body body;
    body.q_WC = map.keyframes[k].q_WC;
    body.p_W = map.keyframes[k].p_W;
    body.v_W = map.keyframes[k].v_W;
    body.w_C = map.keyframes[k].w_C;
    return body;
  }
  void fill() {
    for (int c = 0; c < kPoints; ++c) {
      Vec3 ray;
      TEST_ASSERT_TRUE(unproject(truth,
                                 Vec2(static_cast<Scalar>(random.uniform(40, truth.width - 40)),
                                      static_cast<Scalar>(random.uniform(40, truth.height - 40))),
                                 &ray));
      const Scalar depth = static_cast<Scalar>(random.uniform(1, 3));
      const Vec3 p_W = map.keyframes[0].q_WC * ray * depth + map.keyframes[0].p_W;
      Vec2 z;
      if (!project_row(truth, body(0), p_W, Scalar(1), &z)) continue;
      const int i = map.add(0, z);
      TEST_ASSERT_TRUE(i >= 0);
      map.point(i).rho = 1 / depth;
      map.point(i).has_depth = true;
      tables.features[i].observations = 20;
      for (int k = 1; k < kKeyframes; ++k)
        if (project_row(truth, body(k), p_W, Scalar(1), &z))
          map.keyframes.set_pixel(k, i, z + random.normals<2>(kSigma));
    }
  }
};

void test_a_readout_that_the_calibration_lacks_should_be_found() {
  constexpr int kRuns = 12;
  double squares = 0;
  for (int run = 0; run < kRuns; ++run) {
    RowsBench bench(static_cast<std::uint64_t>(40 + run));
    bench.fill();
    const double before = static_cast<double>(bench.map.keyframes.pixels(1)[3].y);
    for (int again = 0; again < 3; ++again) TEST_ASSERT_TRUE(bench.adjustment.run(true));
    const KeyframeLens& lens = bench.map.lens();
    TEST_ASSERT_EQUAL_INT(1, lens.rows().count);
    const double off = static_cast<double>(lens.camera().readout) - RowsBench::kReadout;
    const double variance = static_cast<double>(lens.readout_variance());
    TEST_ASSERT_TRUE(std::fabs(off) < 2e-3);
    TEST_ASSERT_TRUE(variance < 1e-6);
    TEST_ASSERT_TRUE(std::fabs(static_cast<double>(bench.map.keyframes.pixels(1)[3].y) - before) > 1e-3);
    squares += off * off / variance / kRuns;
  }
  std::printf("readout: mean of squared errors in sigmas %.2f\n", squares);
  TEST_ASSERT_TRUE(squares < 3);
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_a_distortion_that_the_calibration_lacks_should_be_found);
  RUN_TEST(test_bearings_should_follow_the_lens_and_keep_their_pixels);
  RUN_TEST(test_a_point_of_the_target_should_not_follow_the_lens);
  RUN_TEST(test_the_lens_should_stay_where_the_caller_does_not_want_it_adjusted);
  RUN_TEST(test_a_new_map_should_begin_at_the_calibration);
  RUN_TEST(test_a_readout_that_the_calibration_lacks_should_be_found);
  return UNITY_END();
}
