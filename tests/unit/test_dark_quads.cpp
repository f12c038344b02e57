// Dark quadrilaterals in drawn pictures: found, placed to a fraction of a pixel, and not seen where there are none.
#include <cmath>
#include <cstdio>
#include <cstring>
#include <vector>

#include "geometry/so3.h"
#include "support/seeded_random.h"
#include "support/test_cameras.h"
#include "track/quad_refine.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr Scalar kWidth = Scalar(0.1832), kHeight = Scalar(0.1295);

struct Picture {
  int width, height;
  std::vector<std::uint8_t> pixels;
  Picture(int w, int h, std::uint8_t grey) : width(w), height(h), pixels(static_cast<std::size_t>(w * h), grey) {}
  std::uint8_t& at(int x, int y) { return pixels[static_cast<std::size_t>(y * width + x)]; }
  ImageView view() const { return {pixels.data(), width, height, width}; }
};

struct Finder {
  std::vector<unsigned char> block = std::vector<unsigned char>(1 << 20);
  QuadWorkspace workspace;
  Finder(int width, int height) {
    Arena arena(block.data(), block.size());
    workspace = take_quad_workspace(&arena, width, height);
    TEST_ASSERT_TRUE(arena.ok());
  }
  int count(const Picture& picture) const {
    Quad quads[16];
    return find_dark_quads(picture.view(), workspace, quads, 16);
  }
};

PoseEstimate viewpoint(SeededRandom& random, double distance) {
  PoseEstimate pose;
  const Quat turn =
      exp_so3(Vec3(static_cast<Scalar>(random.uniform(-0.6, 0.6)), static_cast<Scalar>(random.uniform(-0.6, 0.6)), 0));
  pose.q_WC = turn * exp_so3(random.normals<3>(0.1));
  pose.p_WC = turn * Vec3(0, 0, static_cast<Scalar>(-distance));
  return pose;
}

/// Grey level of the wall: rectangle 40, a white sheet 220 around it, wall 120. near_edge: within 5 % of the size.
double wall(const Camera& camera, const PoseEstimate& pose, const Vec2& pixel, bool* near_edge) {
  Vec3 ray;
  *near_edge = false;
  if (!unproject(camera, pixel, &ray)) return 120;
  ray = pose.q_WC * ray;
  if (!(ray.z() > 0)) return 120;
  const Vec3 p = pose.p_WC - ray * (pose.p_WC.z() / ray.z());
  const double ax = static_cast<double>(std::abs(p.x()) / kWidth), ay = static_cast<double>(std::abs(p.y()) / kHeight);
  const double a = std::fmax(ax, ay);
  *near_edge = std::fabs(a - 0.5) < 0.05 || std::fabs(a - 0.7) < 0.05;
  return a < 0.5 ? 40 : a < 0.7 ? 220 : 120;
}

/// What the camera sees, with 6 x 6 rays a pixel at the edges.
void draw(const Camera& camera, const PoseEstimate& pose, SeededRandom& random, double noise, Picture* picture) {
  constexpr int kRays = 6;
  for (int y = 0; y < picture->height; ++y) {
    for (int x = 0; x < picture->width; ++x) {
      const Vec2 centre(static_cast<Scalar>(x), static_cast<Scalar>(y));
      bool near_edge, unused;
      double grey = wall(camera, pose, centre, &near_edge);
      if (near_edge) {
        grey = 0;
        for (int s = 0; s < kRays * kRays; ++s) {
          const Vec2 part(static_cast<Scalar>(s % kRays), static_cast<Scalar>(s / kRays));
          const Vec2 offset = (part + Vec2(Scalar(0.5), Scalar(0.5))) / kRays - Vec2(Scalar(0.5), Scalar(0.5));
          grey += wall(camera, pose, centre + offset, &unused) / (kRays * kRays);
        }
      }
      picture->at(x, y) = static_cast<std::uint8_t>(std::fmin(255, std::fmax(0, grey + noise * random.normal() + 0.5)));
    }
  }
}

void test_rectangle_should_be_placed_to_a_tenth_of_a_pixel_when_seen_through_any_lens() {
  SeededRandom random(21);
  for (int k = 0; k < kTestCameras; ++k) {
    const Camera camera = test_camera_of(k);
    const Finder finder(camera.width, camera.height);
    double sum = 0;
    constexpr int kTrials = 4;
    for (int trial = 0; trial < kTrials; ++trial) {
      const PoseEstimate truth = viewpoint(random, 0.5);
      Picture picture(camera.width, camera.height, 0);
      draw(camera, truth, random, 2, &picture);
      RectangleSighting seen;
      TEST_ASSERT_TRUE(
          find_dark_rectangle(picture.view(), camera, kWidth, kHeight, Scalar(0.2), finder.workspace, &seen));
      Vec3 points[4];
      rectangle_points(kWidth, kHeight, points);
      for (int i = 0; i < 4; ++i) {
        Vec2 pixel;
        TEST_ASSERT_TRUE(project_from_pose(camera, truth.q_WC, truth.p_WC, points[i], truth.p_WC, &pixel));
        sum += static_cast<double>((pixel - seen.quad.corners[i]).squaredNorm()) / (8 * kTrials);
      }
      TEST_ASSERT_TRUE(seen.quad.contrast > 100 && seen.quad.rms_px < Scalar(0.3));
    }
    std::printf("model %d: corners %.3f px RMS\n", k + 1, std::sqrt(sum));
    TEST_ASSERT_TRUE(std::sqrt(sum) < 0.1);
  }
}

void test_nothing_should_be_found_when_the_picture_has_no_dark_quadrilateral() {
  const Finder finder(160, 120);
  SeededRandom random(22);
  Picture picture(160, 120, 0);
  TEST_ASSERT_EQUAL_INT(0, finder.count(picture));
  std::memset(picture.pixels.data(), 255, picture.pixels.size());
  TEST_ASSERT_EQUAL_INT(0, finder.count(picture));
  for (std::uint8_t& pixel : picture.pixels) pixel = static_cast<std::uint8_t>(random.uniform(0, 256));
  TEST_ASSERT_EQUAL_INT(0, finder.count(picture));
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 160; ++x) picture.at(x, y) = (x + y) % 2 != 0 ? 255 : 0;
  }
  TEST_ASSERT_EQUAL_INT(0, finder.count(picture));
  for (int y = 0; y < 120; ++y) {  // a spiral: the longest outline
    for (int x = 0; x < 160; ++x)
      picture.at(x, y) = y % 4 < 2 || (x > 155 && y % 8 < 4) || (x < 4 && y % 8 >= 4) ? 0 : 255;
  }
  TEST_ASSERT_EQUAL_INT(0, finder.count(picture));
  for (int y = 0; y < 120; ++y) {  // a dark disc
    for (int x = 0; x < 160; ++x) picture.at(x, y) = std::hypot(x - 80, y - 60) < 40 ? 30 : 220;
  }
  TEST_ASSERT_EQUAL_INT(0, finder.count(picture));
}

/// A grey box on a ground; corners x0 y0 (in) to x1 y1 (out).
Picture box(int x0, int y0, int x1, int y1, std::uint8_t inside, std::uint8_t ground) {
  Picture picture(160, 120, ground);
  for (int y = y0; y < y1; ++y) {
    for (int x = x0; x < x1; ++x) picture.at(x, y) = inside;
  }
  return picture;
}

void test_quad_should_count_only_when_dark_on_light_clear_of_the_border_and_large_enough() {
  const Finder finder(160, 120);
  TEST_ASSERT_EQUAL_INT(1, finder.count(box(40, 30, 110, 80, 40, 200)));
  TEST_ASSERT_EQUAL_INT(0, finder.count(box(40, 30, 110, 80, 200, 40)));
  TEST_ASSERT_EQUAL_INT(0, finder.count(box(40, 30, 110, 80, 130, 145)));
  TEST_ASSERT_EQUAL_INT(0, finder.count(box(0, 30, 110, 80, 40, 200)));
  TEST_ASSERT_EQUAL_INT(0, finder.count(box(40, 30, 160, 80, 40, 200)));
  TEST_ASSERT_EQUAL_INT(0, finder.count(box(40, 30, 45, 36, 40, 200)));
  TEST_ASSERT_EQUAL_INT(0, finder.count(box(40, 30, 110, 34, 40, 200)));
}

void test_corners_should_come_in_upright_order_when_the_quad_is_rolled() {
  const Finder finder(160, 120);
  for (int degrees = -40; degrees <= 40; degrees += 10) {
    const double a = degrees * 3.14159265358979 / 180, c = std::cos(a), s = std::sin(a);
    Picture picture(160, 120, 210);
    for (int y = 0; y < 120; ++y) {
      for (int x = 0; x < 160; ++x) {
        const double u = c * (x - 80) + s * (y - 60), v = -s * (x - 80) + c * (y - 60);
        if (std::fabs(u) < 35 && std::fabs(v) < 25) picture.at(x, y) = 50;
      }
    }
    Quad quads[4];
    TEST_ASSERT_EQUAL_INT(1, find_dark_quads(picture.view(), finder.workspace, quads, 4));
    const double signs[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    for (int i = 0; i < 4; ++i) {
      const double u = 35 * signs[i][0], v = 25 * signs[i][1];
      TEST_ASSERT_DOUBLE_WITHIN(1.5, 80 + c * u - s * v, static_cast<double>(quads[0].corners[i].x()));
      TEST_ASSERT_DOUBLE_WITHIN(1.5, 60 + s * u + c * v, static_cast<double>(quads[0].corners[i].y()));
    }
  }
}

void test_strongest_quads_should_be_kept_when_there_are_more_than_fit() {
  const Finder finder(160, 120);
  Picture picture(160, 120, 220);
  for (int k = 0; k < 4; ++k) {
    for (int y = 40; y < 70; ++y) {
      for (int x = 10 + 37 * k; x < 35 + 37 * k; ++x) picture.at(x, y) = static_cast<std::uint8_t>(120 - 30 * k);
    }
  }
  Quad quads[4];
  TEST_ASSERT_EQUAL_INT(4, find_dark_quads(picture.view(), finder.workspace, quads, 4));
  TEST_ASSERT_EQUAL_INT(2, find_dark_quads(picture.view(), finder.workspace, quads, 2));
  TEST_ASSERT_EQUAL_INT(190, static_cast<int>(quads[0].contrast));
  TEST_ASSERT_EQUAL_INT(160, static_cast<int>(quads[1].contrast));
  TEST_ASSERT_EQUAL_INT(0, find_dark_quads(picture.view(), finder.workspace, quads, 0));
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_rectangle_should_be_placed_to_a_tenth_of_a_pixel_when_seen_through_any_lens);
  RUN_TEST(test_nothing_should_be_found_when_the_picture_has_no_dark_quadrilateral);
  RUN_TEST(test_quad_should_count_only_when_dark_on_light_clear_of_the_border_and_large_enough);
  RUN_TEST(test_corners_should_come_in_upright_order_when_the_quad_is_rolled);
  RUN_TEST(test_strongest_quads_should_be_kept_when_there_are_more_than_fit);
  return UNITY_END();
}
