#include "sim/scene_road.h"

#include <algorithm>
#include <cmath>

#include "sim/scene_builder.h"

namespace pf::sim {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kBefore = 6.0, kAfter = 18.0;            // of what is there beyond the ends of the way [m]
constexpr double kEye = 1.6;                              // of the camera above the ground [m]
constexpr double kFront = 8.0, kHigh = 7.0;               // width and height of a front [m]
constexpr double kFrontNear = 2.5, kFrontFar = 6.0;       // of fronts from the kerb [m]
constexpr double kTargetSize = 6.0;                       // times the usual target
constexpr double kClear = 1.4;                            // half of what stays free before the target [m]
constexpr double kRestSeconds = 1.0, kEaseSeconds = 2.0;  // before it moves, and until it has its speed
const Vec3 kRight{1, 0, 0}, kDown{0, 1, 0}, kAway{0, 0, 1};

bool hides_target(const SceneOptions& options, double x, double reach) {
  return options.target && std::abs(x) < kClear + reach;
}

}  // namespace

Scene make_road(Random& random, const SceneOptions& options) {
  Builder b(random, options);
  const double begin = -kBefore, end = kRoadLength + kAfter, top = kEye - kHigh;
  // The sky's edge: a row of hills behind all.
  b.add({begin - 30, top - 4, 30}, kRight, kDown, end - begin + 60, kHigh + 8, 0.06, 140,
        [&](Canvas& c) { b.clutter(c, 2.5, 50); });
  for (double x = begin; x < end; x += kFront) {
    const double z = random.uniform(kFrontNear, kFrontFar), width = random.uniform(0.75, 1.0) * kFront;
    b.add({x, top, z}, kRight, kDown, width, kHigh, 0.015, static_cast<float>(random.uniform(90, 150)), [&](Canvas& c) {
      b.clutter(c, 0.5, 60);
      b.papers(c, 8, 1.2);
    });
    // The side that the camera sees as it comes, back to the hills.
    b.add({x, top, z + 3}, -kAway, kDown, 3, kHigh, 0.02, 100, [&](Canvas& c) { b.clutter(c, 0.5, 50); });
    b.add({x, kEye, kFrontFar}, kRight, -kAway, kFront, kFrontFar + kRoadNear, 0.02, 100,
          [&](Canvas& c) { b.clutter(c, 0.4, 30); });
  }
  const auto paint = [&](Canvas& c) { b.clutter(c, 0.25, 70); };
  for (double x = begin; x < end; x += random.uniform(0.7, 1.6)) {  // poles
    const double z = random.uniform(-0.6, 1.8), width = random.uniform(0.1, 0.3), height = random.uniform(2.0, 4.5);
    if (hides_target(options, x, width)) continue;
    b.add({x - 0.5 * width, kEye - height, z}, kRight, kDown, width, height, 0.008,
          static_cast<float>(random.uniform(60, 190)), paint);
  }
  for (double x = begin; x < end; x += random.uniform(3.0, 6.0)) {  // parked boxes
    const Vec3 size{random.uniform(1.0, 3.5), random.uniform(0.7, 1.7), random.uniform(0.8, 1.6)};
    const double yaw = random.uniform(-0.15, 0.15), z = random.uniform(0.2, 1.2);
    if (hides_target(options, x, 0.5 * size.x + 0.3)) continue;
    b.add_box({x, kEye, z}, size, yaw, 0.012, static_cast<float>(random.uniform(80, 160)), 0.25, 65, nullptr);
  }
  for (double x = begin; x < end; x += random.uniform(1.2, 2.6)) {  // signs and boards, at any height
    const double width = random.uniform(0.3, 1.0), height = random.uniform(0.3, 0.8);
    const double y = random.uniform(-1.8, 0.9), z = random.uniform(-0.3, 2.2), yaw = random.uniform(-0.5, 0.5);
    if (hides_target(options, x, width)) continue;
    const Vec3 u{std::cos(yaw), 0, std::sin(yaw)};
    b.add(Vec3{x, y, z} - u * (0.5 * width), u, kDown, width, height, 0.008,
          static_cast<float>(random.uniform(60, 180)), paint);
  }
  if (options.target) {
    const double half_x = 0.5 * kTargetSize * Builder::kTargetWidth + 0.5;
    const double half_y = 0.5 * kTargetSize * Builder::kTargetHeight + 0.4;
    b.add({-half_x, -half_y, 0}, kRight, kDown, 2 * half_x, 2 * half_y, 0.006, 150, [&](Canvas& c) {
      b.clutter(c, 0.25, 70);
      const double a = 0.5 * kTargetSize * Builder::kTargetWidth, h = 0.5 * kTargetSize * Builder::kTargetHeight;
      const double margin = 0.2;
      paint_box(c, half_x - a - margin, half_y - h - margin, half_x + a + margin, half_y + h + margin, 225);
      paint_box(c, half_x - a, half_y - h, half_x + a, half_y + h, 25);
    });
    b.scene.target_width = kTargetSize * Builder::kTargetWidth;
    b.scene.target_height = kTargetSize * Builder::kTargetHeight;
  }
  return std::move(b.scene);
}

Trajectory road_path(Random& random) {
  const double bob = random.uniform(0.04, 0.08), sway = random.uniform(0.1, 0.3), phase = random.uniform(0, 2 * kPi);
  return [=](double t) {
    const double speed = kRoadLength / (kRoadSeconds - kRestSeconds - 0.5 * kEaseSeconds);
    const double since = std::max(0.0, t - kRestSeconds);
    const double run = since < kEaseSeconds ? since * since / (2 * kEaseSeconds) : since - 0.5 * kEaseSeconds;
    // It looks at the fronts and somewhat ahead; from rest all of this begins as slowly as the way does.
    const double yaw = 0.1 + 0.25 * run * run / (1 + run * run) + 0.08 * std::sin(2 * kPi * run / 7.0);
    return Pose{look_along({std::sin(yaw), 0, std::cos(yaw)}, kDown),
                {speed * run, bob * (std::sin(2 * kPi * run / 2.0 + phase) - std::sin(phase)),
                 -kRoadNear + sway * (std::cos(2 * kPi * run / 9.0) - 1)}};
  };
}

}  // namespace pf::sim
