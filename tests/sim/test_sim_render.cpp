// Rendered pictures: the same for the same seed, every thing where the camera model says, depth and surfaces exact.
#include <cmath>
#include <cstdio>
#include <cstring>
#include <vector>

#include "planefold_platform/sim.h"
#include "sim/paths.h"
#include "sim/render.h"
#include "unity.h"

using namespace pf::sim;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr std::uint64_t kSeed = 5;

pf_camera_t camera_of(int model) {
  pf_camera_t c{model, 320, 240, 205, 203, 158.3, 121.2, {}, 0, PF_CAMERA_EXACT, PF_TIMESTAMPS_REAL, 0, 0, 0, {}};
  const double radtan[5] = {-0.20, 0.04, 0.0004, -0.0003, 0}, equidistant[4] = {-0.01, 0.004, -0.003, 0.0006};
  if (model == PF_CAMERA_RADTAN) std::memcpy(c.distortion, radtan, sizeof radtan);
  if (model == PF_CAMERA_EQUIDISTANT) std::memcpy(c.distortion, equidistant, sizeof equidistant);
  if (model == PF_CAMERA_DIVISION) c.distortion[0] = 9e-6;
  return c;
}

bool project(const pf_camera_t& camera, const Pose& pose, const Vec3& p_W, double pixel[2]) {
  const Vec3 p = pose.R_WC.transposed() * (p_W - pose.p_WC);
  const double p_C[3] = {p.x, p.y, p.z};
  return pf_camera_project(&camera, p_C, pixel) == PF_OK;
}

/// Where four squares of a checker meet: the point that every gradient in the window is orthogonal to the way to.
bool find_corner(const std::vector<float>& image, int width, int height, double pixel[2]) {
  for (int iteration = 0; iteration < 20; ++iteration) {
    double A[3] = {}, b[2] = {};
    const int ci = static_cast<int>(std::lround(pixel[0])), cj = static_cast<int>(std::lround(pixel[1]));
    if (ci < 8 || cj < 8 || ci >= width - 8 || cj >= height - 8) return false;
    for (int j = cj - 5; j <= cj + 5; ++j)
      for (int i = ci - 5; i <= ci + 5; ++i) {
        const auto at = [&](int x, int y) {
          return static_cast<double>(image[static_cast<std::size_t>(y * width + x)]);
        };
        const double gx = at(i + 1, j) - at(i - 1, j), gy = at(i, j + 1) - at(i, j - 1);
        const double dx = i - pixel[0], dy = j - pixel[1], w = std::exp(-(dx * dx + dy * dy) / 12);
        A[0] += w * gx * gx;
        A[1] += w * gx * gy;
        A[2] += w * gy * gy;
        b[0] += w * (gx * gx * i + gx * gy * j);
        b[1] += w * (gx * gy * i + gy * gy * j);
      }
    const double det = A[0] * A[2] - A[1] * A[1];
    if (det < 1e-6 * A[0] * A[2]) return false;
    const double x = (A[2] * b[0] - A[1] * b[1]) / det, y = (A[0] * b[1] - A[1] * b[0]) / det;
    const double step = std::hypot(x - pixel[0], y - pixel[1]);
    pixel[0] = x;
    pixel[1] = y;
    if (step < 1e-4) break;
  }
  return true;
}

void test_checker_corners_should_appear_where_they_project_with_every_camera_model() {
  const int squares = 16;
  const double square = 0.08;
  const Scene scene = make_checker(square, squares);
  for (int model = PF_CAMERA_PINHOLE; model <= PF_CAMERA_DIVISION; ++model) {
    const pf_camera_t camera = camera_of(model);
    Renderer renderer(camera, 2);
    TEST_ASSERT_TRUE(renderer.ok());
    double sum[2] = {}, square_sum = 0, worst = 0;
    int count = 0;
    for (int view = 0; view < 3; ++view) {
      const Pose pose{rotation_exp({0.15 * (view - 1), 0.4 * (view - 1), 0.1 * view}),
                      {-0.28 * (view - 1) + 0.011, 0.05, -0.62 - 0.05 * view}};
      std::vector<float> image(320 * 240, 0.0f);
      renderer.render(scene, {pose}, 1.0f, image);
      for (int b = 1; b < squares; ++b)
        for (int a = 1; a < squares; ++a) {
          double truth[2], found[2];
          if (!project(camera, pose, {(a - squares / 2) * square, (b - squares / 2) * square, 0}, truth)) continue;
          if (truth[0] < 10 || truth[1] < 10 || truth[0] > 309 || truth[1] > 229) continue;
          found[0] = truth[0];
          found[1] = truth[1];
          if (!find_corner(image, 320, 240, found)) continue;
          const double e[2] = {found[0] - truth[0], found[1] - truth[1]};
          for (int k = 0; k < 2; ++k) sum[k] += e[k];
          square_sum += e[0] * e[0] + e[1] * e[1];
          worst = std::max(worst, std::hypot(e[0], e[1]));
          ++count;
        }
    }
    std::printf("model %d: %d corners, rms %.4f px, worst %.4f px, mean (%.4f, %.4f)\n", model, count,
                std::sqrt(square_sum / count), worst, sum[0] / count, sum[1] / count);
    TEST_ASSERT_GREATER_THAN_INT(100, count);
    TEST_ASSERT_TRUE(std::sqrt(square_sum / count) < 0.05);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0, sum[0] / count);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0, sum[1] / count);
    TEST_ASSERT_TRUE(worst < 0.15);
  }
}

std::vector<std::uint8_t> frame_of(const char* scene, const pf_sim_options_t& options, int frame) {
  pf_sim_t* sim = pf_sim_open(scene, &options);
  TEST_ASSERT_NOT_NULL(sim);
  pf_image_t image{};
  for (int k = 0; k <= frame; ++k) TEST_ASSERT_EQUAL_INT(1, pf_sim_next(sim, &image, nullptr));
  std::vector<std::uint8_t> copy(image.pixels, image.pixels + image.stride * image.height);
  pf_sim_close(sim);
  return copy;
}

void test_four_places_of_a_texture_should_be_the_same_as_each_by_itself_to_the_bit() {
  Random random(kSeed);
  Canvas canvas(0.5, 0.3, 0.001, 128);
  paint_noise(canvas, random, 60, 0.1, 6, 0.7);
  const Texture texture(canvas);
  int alike = 0;
  for (int i = 0; i < 20000; ++i) {
    const float size = static_cast<float>(0.0005 * std::pow(2.0, random.uniform(0, 10)));
    const float spread = i % 3 == 0 ? 2.0f : i % 3 == 1 ? 0.1f : 0.001f;
    Four u, v, footprint;
    for (int k = 0; k < 4; ++k) {
      u[k] = static_cast<float>(random.uniform(-0.1, 0.6));
      v[k] = static_cast<float>(random.uniform(-0.1, 0.4));
      footprint[k] = size * (1 + spread * static_cast<float>(random.uniform()));
    }
    const Four four_greys = texture.sample(u, v, footprint);
    for (int k = 0; k < 4; ++k) {
      const float grey = four_greys[k], alone = texture.sample(u[k], v[k], footprint[k]);
      alike += std::memcmp(&grey, &alone, sizeof grey) == 0 ? 1 : 0;
    }
  }
  TEST_ASSERT_EQUAL_INT(4 * 20000, alike);
}

void test_four_rays_at_a_time_should_see_what_each_sees_by_itself_to_the_bit() {
  const struct {
    Scene (*make)(Random&, const SceneOptions&);
    Trajectory (*path)(Random&);
    bool person;
  } kinds[] = {{make_room, room_path, true}, {make_bushes, bushes_path, false}};
  for (const auto& kind : kinds) {
    Random scenery(kSeed), way(kSeed + 1);
    const Scene scene = kind.make(scenery, SceneOptions{true, false, kind.person});
    const Trajectory path = kind.path(way);
    const pf_camera_t camera{PF_CAMERA_PINHOLE,  96, 72, 62, 61, 47.3, 36.2, {}, 0, PF_CAMERA_EXACT,
                             PF_TIMESTAMPS_REAL, 0,  0,  0,  {}};
    Renderer renderer(camera, 3);  // nine samples: two fours, and one by itself
    for (int view = 0; view < 3; ++view) {
      std::vector<Pose> rows;
      for (int j = 0; j < (view == 0 ? 1 : 72); ++j) rows.push_back(path(3.0 * view + 1e-4 * j));
      std::vector<float> fours(96 * 72, 0.0f), ones(96 * 72, 0.0f);
      renderer.render(scene, rows, 1.0f, fours);
      renderer.one_by_one = true;
      renderer.render(scene, rows, 1.0f, ones);
      renderer.one_by_one = false;
      TEST_ASSERT_EQUAL_MEMORY(ones.data(), fours.data(), ones.size() * sizeof(float));
    }
  }
}

void test_pixels_should_be_the_same_for_the_same_seed_and_not_for_another() {
  pf_sim_options_t options;
  pf_sim_options_default("wall", &options);
  options.seed = kSeed;
  options.samples = 1;
  const auto a = frame_of("wall", options, 3), b = frame_of("wall", options, 3);
  TEST_ASSERT_EQUAL_UINT8_ARRAY(a.data(), b.data(), a.size());
  options.seed = kSeed + 1;
  TEST_ASSERT_TRUE(frame_of("wall", options, 3) != a);
}

void test_target_edges_should_lie_where_the_truth_puts_them() {
  pf_sim_options_t options;
  pf_sim_options_default("wall", &options);
  options.seed = kSeed;
  options.noise_grey = 0;
  pf_sim_t* sim = pf_sim_open("wall", &options);
  pf_target_t target;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_sim_target(sim, PF_TARGET_POINTS, &target));
  pf_image_t image;
  pf_pose_t truth;
  TEST_ASSERT_EQUAL_INT(1, pf_sim_next(sim, &image, &truth));
  const Pose pose{rotation_of(truth.q_WC), {truth.p_WC[0], truth.p_WC[1], truth.p_WC[2]}};
  // Across the middle of the left and right edges: the amount of light in a row says where the step is.
  for (int side = -1; side <= 1; side += 2) {
    double edge[2];
    TEST_ASSERT_TRUE(project(options.camera, pose, {side * 0.5 * target.width, 0, 0}, edge));
    const int j = static_cast<int>(std::lround(edge[1])), i0 = static_cast<int>(edge[0]) - 6;
    const auto at = [&](int i) { return static_cast<double>(image.pixels[j * image.stride + i]); };
    const double left = at(i0), right = at(i0 + 12);
    double light = 0;
    for (int i = i0; i <= i0 + 12; ++i) light += at(i);
    // light = left * n + right * (13 - n), with the step n pixels after the left border of the first one
    const double n = (light - 13 * right) / (left - right);
    const double found = i0 - 0.5 + n;
    // The edge is slanted a little: its place in row j, not in that of the projected middle.
    double above[2];
    TEST_ASSERT_TRUE(project(options.camera, pose, {side * 0.5 * target.width, 0.01, 0}, above));
    const double expected = edge[0] + (j - edge[1]) * (above[0] - edge[0]) / (above[1] - edge[1]);
    std::printf("edge at %.3f, found at %.3f\n", expected, found);
    TEST_ASSERT_DOUBLE_WITHIN(0.08, expected, found);
  }
  pf_sim_close(sim);
}

void test_depth_should_satisfy_the_plane_of_its_surface_at_every_pixel() {
  pf_sim_options_t options;
  pf_sim_options_default("desk", &options);
  options.seed = kSeed;
  options.samples = 1;
  pf_sim_t* sim = pf_sim_open("desk", &options);
  pf_pose_t pose;
  pf_sim_pose_at(sim, 4000000000, &pose);
  std::vector<float> depth(320 * 240);
  std::vector<std::int32_t> surface(320 * 240);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_sim_depth(sim, &pose, depth.data(), surface.data()));
  const Pose view{rotation_of(pose.q_WC), {pose.p_WC[0], pose.p_WC[1], pose.p_WC[2]}};
  double worst = 0;
  int hits = 0, kinds[64] = {}, distinct = 0;
  for (int j = 0; j < 240; ++j)
    for (int i = 0; i < 320; ++i) {
      const auto at = static_cast<std::size_t>(j * 320 + i);
      if (surface[at] < 0) continue;
      const double pixel[2] = {static_cast<double>(i), static_cast<double>(j)};
      double ray[3], n[3], d;
      TEST_ASSERT_EQUAL_INT(PF_OK, pf_camera_unproject(&options.camera, pixel, ray));
      TEST_ASSERT_EQUAL_INT(PF_OK, pf_sim_surface(sim, surface[at], n, &d));
      const double along = static_cast<double>(depth[at]) / ray[2];
      const Vec3 p = view.p_WC + view.R_WC * (Vec3{ray[0], ray[1], ray[2]} * along);
      worst = std::max(worst, std::fabs(Vec3{n[0], n[1], n[2]}.dot(p) - d));
      ++hits;
      distinct += kinds[surface[at] & 63]++ == 0;
    }
  std::printf("%d pixels on %d surfaces, farthest from its plane %.2e m\n", hits, distinct, worst);
  TEST_ASSERT_GREATER_THAN_INT(70000, hits);
  TEST_ASSERT_GREATER_THAN_INT(5, distinct);
  TEST_ASSERT_TRUE(worst < 1e-6);
  pf_sim_close(sim);
}

/// Through a rolling shutter each row is what a camera sees that stands where the camera is when the row is read out. What is left is the
/// motion within a row: half a row's time on each side of its middle.
void test_rows_should_each_be_seen_from_the_pose_of_their_own_time() {
  constexpr double kReadout = 0.03, kMaxPixels = 0.05;
  for (const char* scene : {"room", "desk"}) {
    pf_sim_options_t options;
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_sim_options_default(scene, &options));
    options.seed = kSeed;
    pf_sim_t* sim = pf_sim_open(scene, &options);
    TEST_ASSERT_NOT_NULL(sim);
    const int width = options.camera.width, height = options.camera.height;
    const auto pose_of = [&](double t, double row) {
      pf_pose_t pose;
      const double tau = kReadout * ((row + 0.5) / height - 0.5);
      pf_sim_pose_at(sim, static_cast<std::int64_t>(std::llround(1e9 * (t + tau))), &pose);
      return pose;
    };
    const auto camera_of_pose = [](const pf_pose_t& p) {
      return Pose{rotation_of(p.q_WC), {p.p_WC[0], p.p_WC[1], p.p_WC[2]}};
    };
    double within = 0, sheared = 0;
    for (const double t : {1.0, 4.2, 7.7, 11.3}) {
      std::vector<pf_pose_t> poses;
      for (int j = 0; j < height; ++j) poses.push_back(pose_of(t, j));
      pf_image_t image;
      TEST_ASSERT_EQUAL_INT(PF_OK, pf_sim_render_rows(sim, poses.data(), &image));
      TEST_ASSERT_EQUAL_INT64(poses[static_cast<std::size_t>(height / 2)].t_ns, image.t_ns);
      const std::vector<std::uint8_t> rows(image.pixels, image.pixels + width * height);
      for (int j = 3; j < height; j += 29) {
        const pf_pose_t& pose = poses[static_cast<std::size_t>(j)];
        TEST_ASSERT_EQUAL_INT(PF_OK, pf_sim_render(sim, &pose, &image));
        TEST_ASSERT_EQUAL_UINT8_ARRAY(image.pixels + j * width, rows.data() + j * width, width);
        std::vector<float> depth(rows.size());
        TEST_ASSERT_EQUAL_INT(PF_OK, pf_sim_depth(sim, &pose, depth.data(), nullptr));
        for (int i = 5; i < width; i += 31) {
          const double pixel[2] = {static_cast<double>(i), static_cast<double>(j)};
          const float z = depth[static_cast<std::size_t>(j * width + i)];
          double ray[3];
          if (z <= 0 || pf_camera_unproject(&options.camera, pixel, ray) != PF_OK) continue;
          const Pose here = camera_of_pose(pose);
          const Vec3 p_W = here.R_WC * (Vec3{ray[0], ray[1], ray[2]} * (z / ray[2])) + here.p_WC;
          for (const double edge : {-0.5, 0.5}) {
            double seen[2];
            TEST_ASSERT_TRUE(project(options.camera, camera_of_pose(pose_of(t, j + edge)), p_W, seen));
            within = std::max(within, std::hypot(seen[0] - pixel[0], seen[1] - pixel[1]));
          }
          double at_once[2];
          if (project(options.camera, camera_of_pose(pose_of(t, 0.5 * height - 0.5)), p_W, at_once))
            sheared = std::max(sheared, std::hypot(at_once[0] - pixel[0], at_once[1] - pixel[1]));
        }
      }
    }
    std::printf("%s: %.2f px between rows at once and over 30 ms, %.4f px within a row\n", scene, sheared, within);
    TEST_ASSERT_TRUE(within < kMaxPixels);
    TEST_ASSERT_TRUE(sheared > 20 * within);  // and rows differ
    pf_sim_close(sim);
  }
}

void test_swing_should_reach_its_rate_between_its_times_and_leave_the_rest_of_the_path() {
  constexpr double kFrom = 2.0, kTo = 4.5, kRate = 3.5;  // [s], [rad/s]
  pf_sim_options_t options;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_sim_options_default("room", &options));
  options.shake_m = options.shake_rad = 0;
  pf_sim_t* still = pf_sim_open("room", &options);
  options.swing_rad_s = kRate;
  options.swing_from_s = kFrom;
  options.swing_to_s = kTo;
  pf_sim_t* swings = pf_sim_open("room", &options);
  TEST_ASSERT_NOT_NULL(still);
  TEST_ASSERT_NOT_NULL(swings);
  double fastest = 0, jump = 0, before = 0;
  constexpr int kSteps = 6000;
  for (int k = 0; k <= kSteps; ++k) {
    const std::int64_t t_ns = 1000000LL * k;
    pf_pose_t a, b;
    pf_sim_pose_at(still, t_ns, &a);
    pf_sim_pose_at(swings, t_ns, &b);
    for (int i = 0; i < 3; ++i) TEST_ASSERT_EQUAL_DOUBLE(a.p_WC[i], b.p_WC[i]);
    // The swing is the last rotation, so its rate is a difference along y but for the path's own rate, turned by the angle.
    const double rate = b.w_C[1] - a.w_C[1];
    const bool outside = t_ns <= 1e9 * kFrom || t_ns >= 1e9 * kTo;
    for (int i = 0; i < 4 && outside; ++i) TEST_ASSERT_DOUBLE_WITHIN(1e-12, a.q_WC[i], b.q_WC[i]);
    fastest = std::max(fastest, std::fabs(rate));
    jump = std::max(jump, std::fabs(rate - before));
    before = rate;
  }
  std::printf("swing: %.3f rad/s at most of %.1f, its rate changes by %.3f rad/s within a millisecond\n", fastest,
              kRate, jump);
  TEST_ASSERT_DOUBLE_WITHIN(0.02 * kRate, kRate, fastest);
  TEST_ASSERT_TRUE(jump < 0.02 * kRate);  // without a jump
  pf_sim_close(still);
  pf_sim_close(swings);
  options.swing_to_s = kFrom + 0.5;  // less than a swing
  TEST_ASSERT_NULL(pf_sim_open("room", &options));
}

}  // namespace

int main(void) {
  std::printf("seed %llu\n", static_cast<unsigned long long>(kSeed));
  UNITY_BEGIN();
  RUN_TEST(test_checker_corners_should_appear_where_they_project_with_every_camera_model);
  RUN_TEST(test_four_places_of_a_texture_should_be_the_same_as_each_by_itself_to_the_bit);
  RUN_TEST(test_four_rays_at_a_time_should_see_what_each_sees_by_itself_to_the_bit);
  RUN_TEST(test_pixels_should_be_the_same_for_the_same_seed_and_not_for_another);
  RUN_TEST(test_target_edges_should_lie_where_the_truth_puts_them);
  RUN_TEST(test_depth_should_satisfy_the_plane_of_its_surface_at_every_pixel);
  RUN_TEST(test_rows_should_each_be_seen_from_the_pose_of_their_own_time);
  RUN_TEST(test_swing_should_reach_its_rate_between_its_times_and_leave_the_rest_of_the_path);
  return UNITY_END();
}
