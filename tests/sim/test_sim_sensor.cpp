// The simulated sensor and its faults, trajectories, and the statistics of what is drawn.
#include <cmath>
#include <cstdio>
#include <cstring>
#include <vector>

#include "planefold_platform/sim.h"
#include "sim/sensor.h"
#include "sim/trajectory.h"
#include "unity.h"

using namespace pf::sim;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr std::uint64_t kSeed = 21;

void test_noise_should_have_the_given_mean_and_sigma() {
  const Sensor sensor(320, 240, 0);
  const std::vector<float> light(320 * 240, 120.0f);
  std::vector<std::uint8_t> grey;
  Random random(kSeed);
  double sum = 0, square = 0, along = 0, count = 0;
  for (int frame = 0; frame < 10; ++frame) {
    sensor.expose(light, 1, 0, 4, random, grey);
    for (std::size_t i = 0; i < grey.size(); ++i) {
      const double e = grey[i] - 120.0;
      sum += e;
      square += e * e;
      if (i > 0) along += e * (grey[i - 1] - 120.0);
      count += 1;
    }
  }
  const double sigma = std::sqrt(square / count);
  std::printf("mean %.4f, sigma %.4f, correlation of neighbours %.4f\n", sum / count, sigma, along / square);
  TEST_ASSERT_DOUBLE_WITHIN(0.05, 0, sum / count);
  TEST_ASSERT_DOUBLE_WITHIN(0.05, std::sqrt(16 + 1.0 / 12), sigma);  // rounding adds 1/12
  TEST_ASSERT_DOUBLE_WITHIN(0.01, 0, along / square);
}

void test_vignetting_should_darken_the_corners_and_not_the_middle() {
  const Sensor sensor(320, 240, 0.4);
  const std::vector<float> light(320 * 240, 200.0f);
  std::vector<std::uint8_t> grey;
  Random random(kSeed);
  sensor.expose(light, 1, 0, 0, random, grey);
  TEST_ASSERT_UINT8_WITHIN(1, 200, grey[120 * 320 + 160]);
  TEST_ASSERT_UINT8_WITHIN(1, 120, grey[0]);
}

void test_drawn_motion_should_have_the_covariance_of_the_model() {
  const double dt = 1.0 / 30, linear = 1.5, angular = 2.5;
  Random random(kSeed);
  double pp = 0, pv = 0, vv = 0, tt = 0, tw = 0, ww = 0;
  const int n = 40000;
  for (int k = 0; k < n; ++k) {
    MotionState s;
    s.v_W = {0.2, 0, 0};
    draw_motion(s, random, dt, linear, angular, {}, {});
    const double p = s.pose.p_WC.x - 0.2 * dt, v = s.v_W.x - 0.2;
    const Vec3 theta = rotation_log(s.pose.R_WC);
    pp += p * p / n;
    pv += p * v / n;
    vv += v * v / n;
    tt += theta.y * theta.y / n;
    tw += theta.y * s.w_C.y / n;
    ww += s.w_C.y * s.w_C.y / n;
  }
  const double a = linear * linear, b = angular * angular, tolerance = 0.04;
  TEST_ASSERT_DOUBLE_WITHIN(tolerance, 1, pp / (a * dt * dt * dt / 3));
  TEST_ASSERT_DOUBLE_WITHIN(tolerance, 1, pv / (a * dt * dt / 2));
  TEST_ASSERT_DOUBLE_WITHIN(tolerance, 1, vv / (a * dt));
  TEST_ASSERT_DOUBLE_WITHIN(tolerance, 1, tt / (b * dt * dt * dt / 3));
  TEST_ASSERT_DOUBLE_WITHIN(tolerance, 1, tw / (b * dt * dt / 2));
  TEST_ASSERT_DOUBLE_WITHIN(tolerance, 1, ww / (b * dt));
}

void test_steering_should_add_to_the_velocities_in_camera_axes() {
  MotionState s;
  s.pose.R_WC = rotation_exp({0, 1.5707963267948966, 0});  // z_C along x_W
  Random random(kSeed);
  draw_motion(s, random, 0.1, 0, 0, {0, 0, 0.5}, {0, 0.2, 0});
  TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.5, s.v_W.x);
  TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.05, s.pose.p_WC.x);
  TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.2, s.w_C.y);
}

void test_paths_should_be_smooth_and_their_velocities_should_integrate_to_the_poses() {
  for (int k = 0; pf_sim_scene_name(k); ++k) {
    const char* scene = pf_sim_scene_name(k);
    pf_sim_options_t options;
    pf_sim_options_default(scene, &options);
    options.seed = kSeed;
    options.samples = 1;
    pf_sim_t* sim = pf_sim_open(scene, &options);
    TEST_ASSERT_NOT_NULL(sim);
    const std::int64_t step = 10000000;  // 10 ms
    pf_pose_t a, b;
    pf_sim_pose_at(sim, 0, &a);
    double worst_v = 0, worst_w = 0, fastest = 0, hardest = 0;
    for (std::int64_t t = step; t < 1000000000LL * options.frames / 30; t += step) {
      pf_sim_pose_at(sim, t, &b);
      const double dt = 0.01;
      double v2 = 0, dv2 = 0, ev2 = 0;
      for (int i = 0; i < 3; ++i) {
        const double mean = 0.5 * (a.v_W[i] + b.v_W[i]);
        ev2 += std::pow((b.p_WC[i] - a.p_WC[i]) / dt - mean, 2);
        v2 += mean * mean;
        dv2 += std::pow((b.v_W[i] - a.v_W[i]) / dt, 2);
      }
      const Vec3 turn = rotation_log(rotation_of(a.q_WC).transposed() * rotation_of(b.q_WC)) * (1 / dt);
      const Vec3 mean_w = Vec3{a.w_C[0] + b.w_C[0], a.w_C[1] + b.w_C[1], a.w_C[2] + b.w_C[2]} * 0.5;
      worst_v = std::max(worst_v, std::sqrt(ev2));
      worst_w = std::max(worst_w, (turn - mean_w).norm());
      fastest = std::max(fastest, std::sqrt(v2));
      hardest = std::max(hardest, std::sqrt(dv2));
      a = b;
    }
    std::printf("%s: fastest %.2f m/s, hardest %.1f m/s^2, velocity error %.4f m/s, %.4f rad/s\n", scene, fastest,
                hardest, worst_v, worst_w);
    const double driven = 4.5, walked = 1.5;  // [m/s] 72 m of the road are driven in 600 frames
    TEST_ASSERT_TRUE(fastest < (std::strcmp(scene, "road") == 0 ? driven : walked));
    TEST_ASSERT_TRUE(hardest < 10);
    TEST_ASSERT_TRUE(worst_v < 0.01);
    TEST_ASSERT_TRUE(worst_w < 0.02);
    pf_sim_close(sim);
  }
}

void test_faults_should_drop_and_repeat_frames_as_often_as_told() {
  pf_sim_options_t options;
  pf_sim_options_default("wall", &options);
  options.seed = kSeed;
  options.camera = {PF_CAMERA_PINHOLE,  32, 32, 20, 20, 15.5, 15.5, {}, 0, PF_CAMERA_EXACT,
                    PF_TIMESTAMPS_REAL, 0,  0,  0,  {}};
  options.samples = 1;
  options.frames = 600;
  options.drop_probability = 0.2;
  options.repeat_probability = 0.1;
  pf_sim_t* sim = pf_sim_open("wall", &options);
  pf_image_t image;
  std::vector<std::uint8_t> last;
  std::int64_t last_t = -1;
  int frames = 0, repeated = 0;
  while (pf_sim_next(sim, &image, nullptr)) {
    const std::vector<std::uint8_t> now(image.pixels, image.pixels + 32 * 32);
    repeated += now == last;
    TEST_ASSERT_TRUE(image.t_ns > last_t);
    last_t = image.t_ns;
    last = now;
    ++frames;
  }
  std::printf("%d of 600 frames came, %d of them a second time\n", frames, repeated);
  TEST_ASSERT_INT_WITHIN(40, 480, frames);
  TEST_ASSERT_INT_WITHIN(25, 48, repeated);
  pf_sim_close(sim);
}

void test_options_should_be_refused_when_out_of_range() {
  pf_sim_options_t options;
  TEST_ASSERT_EQUAL_INT(PF_ERROR_RANGE, pf_sim_options_default("nowhere", &options));
  TEST_ASSERT_NULL(pf_sim_open("nowhere", nullptr));
  pf_sim_options_default("wall", &options);
  options.exposure_s = 1;
  TEST_ASSERT_NULL(pf_sim_open("wall", &options));
  pf_sim_options_default("wall", &options);
  options.camera.fx = NAN;
  TEST_ASSERT_NULL(pf_sim_open("wall", &options));
}

/// Sum of absolute differences between neighbours of a row: what blur takes away.
double detail(const pf_image_t& image) {
  double sum = 0;
  for (int j = 0; j < image.height; ++j)
    for (int i = 1; i < image.width; ++i)
      sum += std::abs(image.pixels[j * image.stride + i] - image.pixels[j * image.stride + i - 1]);
  return sum;
}

void test_blur_readout_and_exposure_should_change_the_picture() {
  pf_sim_options_t plain;
  pf_sim_options_default("wall", &plain);
  plain.seed = kSeed;
  plain.samples = 1;
  plain.noise_grey = 0;
  const auto frame = [](pf_sim_options_t o, double* how_detailed) {
    pf_sim_t* sim = pf_sim_open("wall", &o);
    TEST_ASSERT_NOT_NULL(sim);
    pf_image_t image{};
    for (int k = 0; k < 130; ++k) TEST_ASSERT_EQUAL_INT(1, pf_sim_next(sim, &image, nullptr));
    *how_detailed = detail(image);
    std::vector<std::uint8_t> copy(image.pixels, image.pixels + image.stride * image.height);
    pf_sim_close(sim);
    return copy;
  };
  double sharp, blurred, ignored;
  const auto reference = frame(plain, &sharp);
  pf_sim_options_t o = plain;
  o.exposure_s = 0.033;
  o.blur_samples = 6;
  frame(o, &blurred);
  std::printf("detail %.0f, blurred %.0f\n", sharp, blurred);
  TEST_ASSERT_TRUE(blurred < 0.95 * sharp);
  o = plain;
  o.readout_s = 0.03;
  const auto rolling = frame(o, &ignored);
  // The middle row keeps its time; the first and the last one do not.
  const auto difference = [&](int row) {
    double sum = 0;
    for (int i = 0; i < 320; ++i)
      sum += std::abs(rolling[static_cast<std::size_t>(row * 320 + i)] -
                      reference[static_cast<std::size_t>(row * 320 + i)]);
    return sum / 320;
  };
  std::printf("rolling: rows differ by %.2f, %.2f, %.2f\n", difference(2), difference(120), difference(237));
  TEST_ASSERT_TRUE(difference(120) < 1.0);
  TEST_ASSERT_TRUE(difference(2) > 1.5 && difference(237) > 1.5);
  o = plain;
  o.exposure_step = 2;
  o.exposure_every = 0.5;
  TEST_ASSERT_TRUE(frame(o, &ignored) != reference);
}

}  // namespace

int main(void) {
  std::printf("seed %llu\n", static_cast<unsigned long long>(kSeed));
  UNITY_BEGIN();
  RUN_TEST(test_noise_should_have_the_given_mean_and_sigma);
  RUN_TEST(test_vignetting_should_darken_the_corners_and_not_the_middle);
  RUN_TEST(test_drawn_motion_should_have_the_covariance_of_the_model);
  RUN_TEST(test_steering_should_add_to_the_velocities_in_camera_axes);
  RUN_TEST(test_paths_should_be_smooth_and_their_velocities_should_integrate_to_the_poses);
  RUN_TEST(test_faults_should_drop_and_repeat_frames_as_often_as_told);
  RUN_TEST(test_options_should_be_refused_when_out_of_range);
  RUN_TEST(test_blur_readout_and_exposure_should_change_the_picture);
  return UNITY_END();
}
