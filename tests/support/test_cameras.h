#pragma once

// Calibrated cameras of every model for the tests.

#include "geometry/camera.h"
#include "unity.h"

namespace pf {

inline Camera test_camera(CameraModel model, int width, int height, double fx, double fy, double cx, double cy,
                          double k0 = 0, double k1 = 0, double k2 = 0, double k3 = 0, double k4 = 0) {
  const double intrinsics[4] = {fx, fy, cx, cy};
  const double distortion[8] = {k0, k1, k2, k3, k4, 0, 0, 0};
  Camera camera;
  TEST_ASSERT_NULL(make_camera(static_cast<int>(model), width, height, intrinsics, distortion, &camera));
  return camera;
}

inline Camera pinhole_camera() { return test_camera(CameraModel::kPinhole, 640, 480, 525, 520, 320, 240); }

/// Two radial terms and a little tangential distortion.
inline Camera radtan_camera() {
  return test_camera(CameraModel::kRadtan, 752, 480, 458.654, 457.296, 367.215, 248.375, -0.28340811, 0.07395907,
                     0.00019359, 1.76187114e-05);
}

inline Camera equidistant_camera() {
  return test_camera(CameraModel::kEquidistant, 512, 512, 190.978, 190.973, 254.931, 256.897, 0.003482389402,
                     0.000715034845, -0.002053236141, 0.000202936736);
}

inline Camera division_camera() { return test_camera(CameraModel::kDivision, 320, 240, 195, 195, 162, 125, 9e-6); }

inline constexpr int kTestCameras = 4;
inline Camera test_camera_of(int index) {
  switch (index) {
    case 0:
      return pinhole_camera();
    case 1:
      return radtan_camera();
    case 2:
      return equidistant_camera();
    default:
      return division_camera();
  }
}

}  // namespace pf
