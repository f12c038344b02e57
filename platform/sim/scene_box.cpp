#include "sim/scene_box.h"

#include <algorithm>
#include <cmath>

#include "sim/scene_builder.h"

namespace pf::sim {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kRestSeconds = 1.0;  // before the circle begins
constexpr double kEaseSeconds = 2.0;  // until the hand has its speed
constexpr double kFloor = 6.0;        // its side [m]
const Vec3 kDown{0, 1, 0};

}  // namespace

Vec3 box_normal(int side) {
  const double a = 0.5 * kPi * side;
  return {std::sin(a), 0, std::cos(a)};
}

Mat3 box_axes(int side) {
  const Vec3 up = -kDown, n = box_normal(side);
  return Mat3::columns(up.cross(n), up, n);
}

Scene make_box(Random& random, const SceneOptions& options) {
  Builder b(random, options);
  const double size = 2 * kBoxHalf, edge = kBoxHalf - kBoxPoster;
  for (int side = 0; side < kBoxSides; ++side) {
    const Mat3 R = box_axes(side);
    const Vec3 x{R(0, 0), R(1, 0), R(2, 0)}, n = box_normal(side);
    b.add(n * kBoxHalf - x * kBoxHalf - kDown * kBoxHalf, x, kDown, size, size, 0.001, 120, [&](Canvas& c) {
      b.clutter(c, 0.12, 70);
      b.papers(c, 6, 0.4);
      // Bare board around the poster.
      paint_box(c, 0, 0, size, edge, 90);
      paint_box(c, 0, size - edge, size, size, 90);
      paint_box(c, 0, 0, edge, size, 90);
      paint_box(c, size - edge, 0, size, size, 90);
    });
  }
  b.add({-0.5 * kFloor, kBoxHalf, 0.5 * kFloor}, {1, 0, 0}, {0, 0, -1}, kFloor, kFloor, 0.006, 110,
        [&](Canvas& c) { b.clutter(c, 0.3, 50); });
  return std::move(b.scene);
}

Trajectory box_circle(double loop_seconds, double begin_rad) {
  return [=](double t) {
    const double since = std::max(0.0, t - kRestSeconds);
    const double run = since < kEaseSeconds ? since * since / (2 * kEaseSeconds) : since - 0.5 * kEaseSeconds;
    const double a = 2 * kPi * run / loop_seconds;
    const Vec3 radial{std::sin(a + begin_rad), 0, std::cos(a + begin_rad)};
    return Pose{look_along(-radial, kDown), radial * kBoxRadius};
  };
}

}  // namespace pf::sim
