#include "sim/scene_builder.h"

namespace pf::sim {
namespace {

constexpr double kBegin = -3, kEnd = 14, kWidth = 2, kCeiling = -1.3, kFloor = 1.3;  // [m]
constexpr double kTexel = 0.004;                                                     // [m]
constexpr double kDoorWidth = 0.9, kDoorHeight = 2.05;                               // [m]

}  // namespace

/// The camera walks along walls with posters and doors and sees them at a slant, near and far at once.
Scene make_corridor(Random& random, const SceneOptions& options) {
  Builder b(random, options);
  const Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  const double length = kEnd - kBegin, height = kFloor - kCeiling;
  const auto wall = [&](bool target) {
    return [&b, &options, target](Canvas& c) {
      b.clutter(c, 0.5, 30);
      b.papers(c, 16, 0.8);
      if (target && options.target) b.paint_target(c, -kBegin, -kCeiling);
    };
  };
  b.add({kBegin, kCeiling, 0}, x, y, length, height, kTexel, 150, wall(true));        // looking along +z
  b.add({kEnd, kCeiling, -kWidth}, -x, y, length, height, kTexel, 140, wall(false));  // along -z
  b.add({kEnd, kCeiling, 0}, -z, y, kWidth, height, kTexel, 120, [&](Canvas& c) {     // the end
    b.clutter(c, 0.4, 30);
    b.papers(c, 2, 0.8);
  });
  b.add({kBegin, kFloor, 0}, x, -z, length, kWidth, 0.006, 90, [&](Canvas& c) { b.clutter(c, 0.3, 20); });
  b.add({kBegin, kCeiling, -kWidth}, x, z, length, kWidth, 0.008, 190, [&](Canvas& c) { b.clutter(c, 0.6, 12); });
  // Doors: their leaves stand 6 cm before the wall, and every third is open.
  const auto leaf = [&](Canvas& c) {
    b.clutter(c, 0.5, 25);
    paint_box(c, 0.78, 1.0, 0.84, 1.2, 40);
    paint_box(c, 0.2, 0.35, 0.7, 0.55, 215);
    paint_print(c, random, 0.23, 0.37, 0.67, 0.53, 0.04);
  };
  for (int k = 0; k < 5; ++k) {
    const double left = 1.8 + 2.4 * k + random.uniform(-0.3, 0.3), top = kFloor - kDoorHeight,
                 open = k % 3 == 2 ? 0.5 : 0;
    const Vec3 near{std::cos(open), 0, -std::sin(open)}, far{-std::cos(open), 0, std::sin(open)};
    b.add({left, top, -0.06}, near, y, kDoorWidth, kDoorHeight, kTexel, 105, leaf);
    b.add({left + 1.2 + kDoorWidth, top, -kWidth + 0.06}, far, y, kDoorWidth, kDoorHeight, kTexel, 115, leaf);
  }
  return std::move(b.scene);
}

}  // namespace pf::sim
