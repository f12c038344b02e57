#include "sim/scene_builder.h"

namespace pf::sim {

Scene make_desk(Random& random, const SceneOptions& options) {
  Builder b(random, options);
  const double top = 0.16, floor = 0.9;  // heights, y down [m]
  const Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  b.add({-2.4, -1.4, 0.95}, x, y, 4.8, 2.4, 0.0025, 150, [&](Canvas& c) {
    b.clutter(c, 0.30, 60);
    b.papers(c, 14, 0.5);
  });
  b.add({-1.7, -1.4, -2.05}, z, y, 3.0, 2.4, 0.004, 130, [&](Canvas& c) { b.clutter(c, 0.3, 60); });
  b.add({-2.4, floor, 1.0}, x, -z, 4.8, 3.4, 0.005, 100, [&](Canvas& c) { b.clutter(c, 0.25, 50); });
  b.add({-1.0, top, 0.75}, x, -z, 2.0, 1.15, 0.001, 120, [&](Canvas& c) {
    b.clutter(c, 0.10, 45);
    b.papers(c, 12, 0.28);
  });
  b.add_box({0, top, 0.08}, {0.40, 0.30, 0.16}, 0, 0.0008, 120, 0.06, 70, [&](Canvas& c) {
    b.clutter(c, 0.06, 70);
    if (options.target) b.paint_target(c, 0.20, 0.14);
  });
  b.add_box({0.55, top, 0.28}, {0.50, 0.36, 0.06}, -0.35, 0.001, 60, 0.05, 80, [&](Canvas& c) {
    paint_box(c, 0.02, 0.02, 0.48, 0.33, 170);
    b.papers(c, 5, 0.22);
    paint_rectangles(c, random, 40, 0.008, 0.05, 100, true);
  });
  b.add_box({-0.55, top, 0.30}, {0.42, 0.30, 0.10}, 0.4, 0.001, 80, 0.05, 80, nullptr);
  for (int k = 0; k < 5; ++k) {
    const double side = k % 2 ? 1 : -1;
    const Vec3 foot{side * random.uniform(0.28, 0.8), top, random.uniform(-0.22, 0.1)};
    const Vec3 size{random.uniform(0.12, 0.24), random.uniform(0.03, 0.14), random.uniform(0.10, 0.2)};
    b.add_box(foot, size, random.uniform(-0.7, 0.7), 0.001, static_cast<float>(random.uniform(70, 180)), 0.05, 70,
              nullptr);
  }
  if (options.person) b.add_person({-2.2, -0.95, 0.55}, {0.45, 0, 0}, x, 1.0);
  return std::move(b.scene);
}

}  // namespace pf::sim
