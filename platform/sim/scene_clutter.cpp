#include "sim/scene_builder.h"

namespace pf::sim {

Scene make_clutter(Random& random, const SceneOptions& options) {
  Builder b(random, options);
  const Vec3 x{1, 0, 0}, y{0, 1, 0};
  const auto paint = [&](Canvas& c) { b.clutter(c, 0.06, 70); };
  const double target_x = 0.17, target_y = 0.14;  // half of its board [m]
  b.add({-2.6, -1.8, 0.9}, x, y, 5.2, 3.6, 0.002, 130, paint);
  constexpr int kColumns = 13, kRows = 8;
  for (int j = 0; j < kRows; ++j)
    for (int i = 0; i < kColumns; ++i) {
      const double depth = random.uniform(-0.05, 0.7), yaw = random.uniform(-0.6, 0.6);
      const bool post = random.uniform() < 0.3;
      const double width = post ? random.uniform(0.03, 0.05) : random.uniform(0.06, 0.14);
      const double height = post ? random.uniform(0.25, 0.5) : random.uniform(0.06, 0.14);
      // Spread evenly over what the camera sees at that depth.
      const double spread = 0.75 + depth;
      const double cx = spread * (0.17 * (i - (kColumns - 1) / 2) + random.uniform(-0.05, 0.05));
      const double cy = spread * (0.17 * (j - (kRows - 1) / 2.0) + random.uniform(-0.05, 0.05));
      const float base = static_cast<float>(random.uniform(80, 180));
      const double reach_x = 0.5 * width + target_x + 0.05, reach_y = 0.5 * height + target_y + 0.05;
      if (options.target && std::abs(cx) < reach_x && std::abs(cy) < reach_y) continue;
      const Vec3 u{std::cos(yaw), 0, std::sin(yaw)};
      const Vec3 corner = Vec3{cx, cy - 0.5 * height, depth} - u * (0.5 * width);
      b.add(corner, u, y, width, height, 0.001, base, paint);
    }
  if (options.target)
    b.add({-target_x, -target_y, 0}, x, y, 2 * target_x, 2 * target_y, 0.0008, 150, [&](Canvas& c) {
      b.clutter(c, 0.06, 70);
      b.paint_target(c, target_x, target_y);
    });
  return std::move(b.scene);
}

}  // namespace pf::sim
