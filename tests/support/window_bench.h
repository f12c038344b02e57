#pragma once

// The map of the window with keyframes and points at known places, without images.

#include "keyframe_slam/adjustment/keyframe_adjustment.h"
#include "keyframe_slam/map/depth.h"
#include "keyframe_slam/planes/plane_upkeep.h"
#include "support/seeded_random.h"
#include "support/test_cameras.h"
#include "support/textured_images.h"

namespace pf {

/// Keyframes side by side that look along z, 0.1 m apart, and points in front of them.
struct KeyframeBench {
  static constexpr int kPoints = 60, kKeyframes = 6;

  SeededRandom random;
  Settings settings;
  Map tables;
  Frame frame;
  NoiseModel noise;
  KeyframeMap map{settings, tables, frame};
  KeyframePlanes planes{settings, map};
  PlaneUpkeep upkeep{settings, map, planes};
  KeyframeAdjustment adjustment{settings, map, planes, noise};
  TestArena arena;
  Vec3 truth_W[kPoints];

  explicit KeyframeBench(std::uint64_t seed) : random(seed) {
    settings.camera = pinhole_camera();
    settings.max_features = kPoints;
    settings.max_planes = 2;
    settings.window_keyframes = 3;
    settings.window_fixed = 3;
    settings.planes = true;
    settings.plane_min_points = 7;
    settings.plane_distance = Scalar(0.01);
    settings.plane_radius = 2;
    settings.fold_sigma = Scalar(0.05);
    settings.fold.roughness = Scalar(0.002);
    settings.fold.gate = Scalar(6.63);
    TEST_ASSERT_TRUE(tables.layout(*arena, kPoints, settings.max_planes, 0, 8));
    TEST_ASSERT_TRUE(frame.layout(*arena, 2 * kPoints));
    TEST_ASSERT_TRUE(map.layout(*arena));
    TEST_ASSERT_TRUE(planes.layout(*arena));
    TEST_ASSERT_TRUE(adjustment.layout(*arena));
    tables.init();
    frame.init();
    map.init();
    adjustment.init();
    noise.init(Scalar(0.3));
    for (int k = 0; k < kKeyframes; ++k)
      map.keyframes.add(k, Quat::Identity(), Vec3(Scalar(0.1) * static_cast<Scalar>(k), 0, 0));
  }

  /// A point at a place, which all keyframes see, with pixels off by sigma_px. Returns its row.
  int add(const Vec3& p_W, double sigma_px) {
    Vec2 z;
    TEST_ASSERT_TRUE(project(settings.camera, p_W - map.keyframes[0].p_W, &z));
    const int i = map.add(0, z);
    TEST_ASSERT_TRUE(i >= 0);
    truth_W[i] = p_W;
    tables.features[i].observations = 20;
    for (int k = 1; k < kKeyframes; ++k) {
      TEST_ASSERT_TRUE(project(settings.camera, p_W - map.keyframes[k].p_W, &z));
      map.keyframes.set_pixel(k, i, z + random.normals<2>(sigma_px));
    }
    return i;
  }
  /// Gives a point its true depth.
  void place(int i) {
    map.place(i, truth_W[i]);
    map.point(i).variance = depth_by_pixels(map, i, noise.sigma_info()).variance;
  }
};

}  // namespace pf
