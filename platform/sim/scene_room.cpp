#include "sim/scene_builder.h"

namespace pf::sim {

Scene make_room(Random& random, const SceneOptions& options) {
  Builder b(random, options);
  const double ceiling = -1.2, floor = 1.4, texel = 0.003;
  const Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  const auto wall = [&](bool target) {
    return [&b, &options, target](Canvas& c) {
      b.clutter(c, 0.35, 65);
      b.papers(c, 9, 0.6);
      if (target && options.target) b.paint_target(c, 2.0, 1.2);
    };
  };
  b.add({-2, ceiling, 0}, x, y, 4, 2.6, 0.002, 140, wall(true));    // looking along +z
  b.add({2, ceiling, -4}, -x, y, 4, 2.6, texel, 130, wall(false));  // along -z
  b.add({-2, ceiling, -4}, z, y, 4, 2.6, texel, 120, wall(false));  // along -x
  b.add({2, ceiling, 0}, -z, y, 4, 2.6, texel, 150, wall(false));   // along +x
  b.add({-2, floor, 0}, x, -z, 4, 4, 0.004, 100, [&](Canvas& c) { b.clutter(c, 0.35, 45); });
  b.add({-2, ceiling, -4}, x, z, 4, 4, 0.005, 180, [&](Canvas& c) { b.clutter(c, 0.5, 30); });
  b.add_box({1.2, floor, -0.35}, {0.9, 1.1, 0.5}, 0, 0.003, 110, 0.2, 60, nullptr);
  b.add_box({-1.4, floor, -0.6}, {0.6, 0.7, 0.5}, 0.5, 0.003, 150, 0.2, 60, nullptr);
  b.add_box({1.5, floor, -3.0}, {0.6, 1.5, 0.8}, 0.1, 0.003, 90, 0.2, 60, nullptr);
  b.add_box({-1.5, floor, -3.3}, {0.8, 0.9, 0.6}, -0.4, 0.003, 130, 0.2, 60, nullptr);
  if (options.person) b.add_person({-1.9, -0.3, -0.55}, {0.32, 0, 0}, x, 0.95);
  return std::move(b.scene);
}

}  // namespace pf::sim
