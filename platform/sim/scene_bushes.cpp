#include "sim/scene_builder.h"

namespace pf::sim {

Scene make_bushes(Random& random, const SceneOptions& options) {
  Builder b(random, options);
  const double target_x = 0.17, target_y = 0.14;  // half of its board [m]
  constexpr int kLeaves = 420;
  for (int k = 0; k < kLeaves; ++k) {
    // Evenly over what the camera sees at that depth, a third of it nearer than the target.
    const double depth = random.uniform(-0.25, 0.6), spread = 0.75 + depth;
    const double cx = spread * random.uniform(-1.15, 1.15), cy = spread * random.uniform(-0.75, 0.75);
    const double yaw = random.uniform(-0.9, 0.9), pitch = random.uniform(-0.9, 0.9), roll = random.uniform(-1.5, 1.5);
    const double width = random.uniform(0.03, 0.07), height = random.uniform(0.03, 0.07);
    const float base = static_cast<float>(random.uniform(60, 200));
    const double reach = 0.5 * std::hypot(width, height) + 0.05;
    // Seen from anywhere on the way, nothing hides the target and nothing shows in the gap around it.
    const double free = depth < 0 ? 0.30 : 0.0;
    if (options.target && std::abs(cx) < target_x + reach + free && std::abs(cy) < target_y + reach + free) continue;
    const Mat3 R = rotation_exp({0, yaw, 0}) * rotation_exp({pitch, 0, 0}) * rotation_exp({0, 0, roll});
    const Vec3 u = R * Vec3{1, 0, 0}, v = R * Vec3{0, 1, 0};
    const Vec3 corner = Vec3{cx, cy, depth} - u * (0.5 * width) - v * (0.5 * height);
    b.add(corner, u, v, width, height, 0.001, base, [&](Canvas& c) { b.clutter(c, 0.04, 60); });
  }
  if (options.target)
    b.add({-target_x, -target_y, 0}, {1, 0, 0}, {0, 1, 0}, 2 * target_x, 2 * target_y, 0.0008, 225,
          [&](Canvas& c) { b.paint_target(c, target_x, target_y); });
  return std::move(b.scene);
}

}  // namespace pf::sim
