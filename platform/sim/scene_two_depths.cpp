#include "sim/scene_builder.h"

namespace pf::sim {

Scene make_two_depths(Random& random, const SceneOptions& options) {
  Builder b(random, options);
  const Vec3 x{1, 0, 0}, y{0, 1, 0};
  const auto paint = [&](Canvas& c) { b.clutter(c, 0.06, 70); };
  const double square = 0.16, depth = 0.35, target_x = 0.17, target_y = 0.14;  // [m]
  b.add({-1.6, -1.1, depth}, x, y, 3.2, 2.2, 0.0015, 130, paint);
  for (int j = -4; j < 4; ++j)
    for (int i = -6; i < 6; ++i) {
      const double left = square * i, top = square * j;
      const bool hidden =
          options.target && left < target_x && left + square > -target_x && top < target_y && top + square > -target_y;
      if ((i + j) % 2 == 0 && !hidden) b.add({left, top, 0}, x, y, square, square, 0.001, 130, paint);
    }
  if (options.target)
    b.add({-target_x, -target_y, 0}, x, y, 2 * target_x, 2 * target_y, 0.0008, 130, [&](Canvas& c) {
      b.clutter(c, 0.06, 70);
      b.paint_target(c, target_x, target_y);
    });
  return std::move(b.scene);
}

}  // namespace pf::sim
