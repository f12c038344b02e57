#include "sim/scene_street.h"

#include <algorithm>
#include <cmath>

#include "sim/scene_builder.h"

namespace pf::sim {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kBefore = 6.0;       // of the fronts that begins before the way does [m]
constexpr double kGround = 6.0;       // side of a piece of the ground [m]
constexpr double kRestSeconds = 1.0;  // before the walk begins
constexpr double kEaseSeconds = 2.0;  // until it has its speed
const Vec3 kRight{1, 0, 0}, kDown{0, 1, 0}, kAway{0, 0, 1};

/// What stands or hangs before a front: each hides a part of it, and moves against it as the camera walks.
void add_obstacles(Builder& b, Random& random, double left) {
  const double texel = 0.012;
  for (int k = 0; k < 2; ++k) {  // pillars
    const Vec3 foot{left + kStreetFront * (0.25 + 0.5 * k) + random.uniform(-0.5, 0.5), kStreetEye, kStreetFar - 0.5};
    b.add_box(foot, {0.4, 4.0, 0.4}, 0, texel, random.uniform(90, 150), 0.25, 50, nullptr);
  }
  for (int k = 0; k < 2; ++k) {  // signs that hang 40 cm before the wall
    const double x = left + random.uniform(0.5, kStreetFront - 3.0), y = random.uniform(-1.6, -0.6);
    b.add({x, y, kStreetFar - 0.4}, kRight, kDown, random.uniform(1.2, 2.2), random.uniform(0.5, 0.8), texel,
          static_cast<float>(random.uniform(60, 180)), [&](Canvas& c) { b.clutter(c, 0.2, 70); });
  }
  for (int k = 0; k < 2; ++k) {  // boxes, parked at the kerb
    const Vec3 foot{left + random.uniform(1.0, kStreetFront - 1.0), kStreetEye, kStreetFar - random.uniform(1.2, 1.8)};
    b.add_box(foot, {random.uniform(1.2, 2.2), random.uniform(0.8, 1.3), 0.9}, random.uniform(-0.2, 0.2), texel, 110,
              0.3, 60, nullptr);
  }
}

}  // namespace

Vec3 street_front(int k) { return {kStreetFront * (k + 0.5) - kBefore, kStreetEye - 0.5 * kStreetHigh, kStreetFar}; }

Mat3 street_axes() { return Mat3::columns(kRight, -kDown, -kAway); }

Scene make_street(Random& random, const SceneOptions& options) {
  Builder b(random, options);
  for (int k = 0; k < kStreetFronts; ++k) {
    const double left = kStreetFront * k - kBefore, top = kStreetEye - kStreetHigh;
    b.add({left, top, kStreetFar}, kRight, kDown, kStreetFront, kStreetHigh, 0.01,
          static_cast<float>(random.uniform(90, 150)), [&](Canvas& c) {
            b.clutter(c, 0.5, 60);
            b.papers(c, 10, 1.4);
          });
    add_obstacles(b, random, left);
  }
  for (double x = -kBefore; x < kStreetFront * kStreetFronts - kBefore; x += kGround)
    b.add({x, kStreetEye, kStreetFar}, kRight, -kAway, kGround, kGround, 0.015, 100,
          [&](Canvas& c) { b.clutter(c, 0.4, 30); });
  return std::move(b.scene);
}

Trajectory street_walk() {
  return [](double t) {
    const double speed = kStreetLength / (kStreetSeconds - kRestSeconds - 0.5 * kEaseSeconds);
    const double since = std::max(0.0, t - kRestSeconds);
    const double run = since < kEaseSeconds ? since * since / (2 * kEaseSeconds) : since - 0.5 * kEaseSeconds;
    // It looks at the fronts, somewhat ahead, and to and fro; from rest this begins as slowly as the walk does.
    const double yaw = 0.3 + 0.15 * std::sin(2 * kPi * run / 9.0);
    return Pose{look_along({std::sin(yaw), 0, std::cos(yaw)}, kDown),
                {speed * run, 0.1 * std::sin(2 * kPi * run / 7.0), 0}};
  };
}

}  // namespace pf::sim
