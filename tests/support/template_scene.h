#pragma once

// Two surfaces side by side that one template sees: a plane on the left of a pixel column and another one behind it on the right.

#include "support/test_cameras.h"
#include "support/textured_images.h"
#include "track/template_matcher.h"

namespace pf {

struct TemplateScene {
  static constexpr int kWidth = 160, kHeight = 120, kSide = 15;

  SeededRandom random;
  Texture near_texture, far_texture;
  Camera camera = test_camera(CameraModel::kPinhole, kWidth, kHeight, 200, 200, 79.5, 59.5);
  Scalar near_depth = 1, far_depth = Scalar(1.8);
  Vec2 near_slope = Vec2::Zero();
  int rim = kWidth;  ///< first column of the first view that shows the surface behind
  Vec2 pixel = Vec2(80, 60);
  double noise = 2;
  TestArena arena;
  Tracker tracker;
  TemplateMatcher matcher;
  Appearance appearance;
  PlanarTemplate shape;
  std::uint8_t mask[PlanarTemplate::kMaxSide * PlanarTemplate::kMaxSide] = {};

  explicit TemplateScene(std::uint64_t seed) : random(seed), near_texture(&random, 5, 25), far_texture(&random, 5, 25) {
    TEST_ASSERT_TRUE(tracker.layout(*arena, kWidth, kHeight) && matcher.layout(*arena, kSide));
    tracker.init(camera);
  }

  TemplateWarp warp_to(const Vec3& c_W, Scalar depth) const {
    TemplateWarp warp;
    warp.ray_0 = Vec2((pixel.x() - camera.cx) / camera.fx, (pixel.y() - camera.cy) / camera.fy);
    warp.t = -c_W / depth;
    return warp;
  }
  Vec2 through(const Mat3& H, double x, double y) const {
    const Vec3 p =
        H * Vec3((static_cast<Scalar>(x) - camera.cx) / camera.fx, (static_cast<Scalar>(y) - camera.cy) / camera.fy, 1);
    return Vec2(camera.fx * p.x() / p.z() + camera.cx, camera.fy * p.y() / p.z() + camera.cy);
  }

  /// What a camera at c_W sees, with the axes of the first one.
  TestImage see(const Vec3& c_W) {
    const Mat3 near_H = warp_to(c_W, near_depth).homography(near_slope).inverse();
    const Mat3 far_H = warp_to(c_W, far_depth).homography(Vec2::Zero()).inverse();
    return TestImage(kWidth, kHeight, [&](int x, int y) {
      const Vec2 n = through(near_H, x, y), f = through(far_H, x, y);
      const bool is_near = n.x() < static_cast<Scalar>(rim) - Scalar(0.5);
      const Texture& texture = is_near ? near_texture : far_texture;
      const Vec2& at = is_near ? n : f;
      return texture.at(static_cast<double>(at.x()), static_cast<double>(at.y())) + noise * random.normal();
    });
  }

  void learn_first(MaskMode mode) {
    matcher.init(camera, mode, 1);
    const TestImage image = see(Vec3::Zero());
    tracker.begin_frame(image.view());
    matcher.begin_frame();
    TEST_ASSERT_TRUE(tracker.remember(pixel, &appearance));
    matcher.begin(tracker.image(), appearance.patch, pixel, &shape, mask);
  }

  SearchTask task(const Vec3& c_W) {
    SearchTask task;
    task.appearance = &appearance;
    task.shape = &shape;
    task.mask = mask;
    const Vec2 ray = warp_to(c_W, near_depth).ray_0;
    task.p_W = near_depth * Vec3(ray.x(), ray.y(), 1);
    task.c_W = c_W;
    task.innovation = Mat2::Identity() * Scalar(0.3);
    TEST_ASSERT_TRUE(project(camera, task.p_W - c_W, &task.predicted));
    return task;
  }
};

}  // namespace pf
