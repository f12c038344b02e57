#include "sim/scene_loop.h"

#include "sim/scene_builder.h"

namespace pf::sim {
namespace {

constexpr double kCeiling = -1.2, kFloor = 1.4;  // [m]
constexpr double kBlock = kLoopSide - 2 * kLoopWidth;
constexpr double kTexel = 0.004;  // [m]

}  // namespace

/// A ring: four walls outside, a block of four walls inside. No two parts are alike.
Scene make_loop(Random& random, const SceneOptions& options) {
  Builder b(random, options);
  const Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  const double half = 0.5 * kLoopSide, inner = 0.5 * kBlock, height = kFloor - kCeiling;
  const auto wall = [&](int papers, bool target) {
    return [&b, &options, papers, target, half](Canvas& c) {
      b.clutter(c, 0.4, 50);
      b.papers(c, papers, 0.7);
      if (target && options.target) b.paint_target(c, half, -kCeiling);
    };
  };
  b.add({-half, kCeiling, 0}, x, y, kLoopSide, height, kTexel, 150, wall(14, true));            // looking along +z
  b.add({half, kCeiling, 0}, -z, y, kLoopSide, height, kTexel, 140, wall(14, false));           // along +x
  b.add({half, kCeiling, -kLoopSide}, -x, y, kLoopSide, height, kTexel, 130, wall(14, false));  // along -z
  b.add({-half, kCeiling, -kLoopSide}, z, y, kLoopSide, height, kTexel, 120, wall(14, false));  // along -x
  const double near = -kLoopWidth, far = kLoopWidth - kLoopSide;
  b.add({inner, kCeiling, near}, -x, y, kBlock, height, kTexel, 135, wall(6, false));   // along -z
  b.add({inner, kCeiling, far}, z, y, kBlock, height, kTexel, 145, wall(6, false));     // along -x
  b.add({-inner, kCeiling, far}, x, y, kBlock, height, kTexel, 125, wall(6, false));    // along +z
  b.add({-inner, kCeiling, near}, -z, y, kBlock, height, kTexel, 155, wall(6, false));  // along +x
  b.add({-half, kFloor, 0}, x, -z, kLoopSide, kLoopSide, 0.006, 95, [&](Canvas& c) { b.clutter(c, 0.35, 30); });
  b.add({-half, kCeiling, -kLoopSide}, x, z, kLoopSide, kLoopSide, 0.008, 190,
        [&](Canvas& c) { b.clutter(c, 0.6, 15); });
  return std::move(b.scene);
}

/// Clockwise seen from above, which is to the right before the first wall. Between the middles of two corners 90 degrees of an arc.
Trajectory loop_path(Random& random) {
  constexpr double kRadius = 1.5, kMid = 0.5 * kLoopWidth, kOutward = 0.7;  // [m], [m], [rad] from the way
  const double half = 0.5 * kLoopSide - kMid, straight = 2 * (half - kRadius), arc = kRadius * 0.5 * 3.14159265358979;
  const double side = straight + arc, centre_z = -0.5 * kLoopSide;
  std::vector<Waypoint> points = {{{0.02, 0.0, -0.70}, {0, 0, 0}},
                                  {{0.10, -0.04, -0.72}, {0.02, 0, 0}},
                                  {{0.22, -0.08, -0.80}, {0.12, 0, 0}},
                                  {{0.36, -0.06, -0.90}, {0.6, 0, 0}},
                                  {{0.56, -0.04, -0.97}, {1.2, 0, 0}}};
  for (int k = 0; k < kLoopSteps; ++k) {
    const double s = 0.8 + kLoopStep * k + 0.5 * straight;  // from the end of a corner
    const int corner = static_cast<int>(s / side);
    const double along = s - corner * side, bend = std::max(0.0, along - straight) / kRadius;
    const double u = -half + kRadius + std::min(along, straight) + kRadius * std::sin(bend);
    const double v = half - kRadius + kRadius * std::cos(bend);  // outwards
    const double a = 0.5 * 3.14159265358979 * corner, look = a + bend - kOutward + 0.25 * std::sin(0.7 * k);
    const Vec3 eye{u * std::cos(a) + v * std::sin(a), 0.02 * (k % 3) - 0.04,
                   centre_z + v * std::cos(a) - u * std::sin(a)};
    const Vec3 at = eye + Vec3{std::cos(look), 0.06 * std::sin(1.1 * k), -std::sin(look)} * 1.5;
    points.push_back({eye + random.normal3() * 0.02, at + random.normal3() * 0.04});
  }
  return spline(points, kLoopInterval);
}

}  // namespace pf::sim
