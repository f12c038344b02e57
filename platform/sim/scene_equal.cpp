#include "sim/scene_builder.h"

namespace pf::sim {
namespace {

constexpr double kTexel = 0.003;                 // [m]
constexpr double kCeiling = -1.2, kFloor = 1.4;  // [m]
const Vec3 kX{1, 0, 0}, kY{0, 1, 0}, kZ{0, 0, 1};

}  // namespace

/// All walls have one texture, and ceiling and floor are bare: whoever sees one wall cannot know which.
Scene make_equal_room(Random& random, const SceneOptions& options) {
  Builder b(random, options);
  constexpr double kSide = 4, kHeight = kFloor - kCeiling;
  b.add({-2, kCeiling, 0}, kX, kY, kSide, kHeight, kTexel, 140, [&](Canvas& c) {
    b.clutter(c, 0.35, 65);
    b.papers(c, 9, 0.6);
  });
  b.add_like_last({2, kCeiling, 0}, -kZ, kY);
  b.add_like_last({2, kCeiling, -kSide}, -kX, kY);
  b.add_like_last({-2, kCeiling, -kSide}, kZ, kY);
  const auto bare = [](Canvas&) {};
  b.add({-2, kFloor, 0}, kX, -kZ, kSide, kSide, 0.02, 100, bare);
  b.add({-2, kCeiling, -kSide}, kX, kZ, kSide, kSide, 0.02, 180, bare);
  return std::move(b.scene);
}

/// Each 2 m of both walls are alike: a door with a picture beside it. Ceiling, floor and end are bare.
Scene make_equal_doors(Random& random, const SceneOptions& options) {
  Builder b(random, options);
  constexpr double kBegin = -3, kPeriod = 2, kWidth = 2, kHeight = kFloor - kCeiling;
  constexpr int kDoors = 9;
  const auto part = [&](Canvas& c) {
    b.clutter(c, 0.4, 40);
    paint_box(c, 0.3, kHeight - 2.05, 1.2, kHeight, 105);
    paint_box(c, 0.36, kHeight - 1.99, 1.14, kHeight - 1.1, 120);
    paint_print(c, random, 0.45, kHeight - 1.8, 1.05, kHeight - 1.4, 0.05);
    b.papers(c, 2, 0.5);
  };
  for (int k = 0; k < kDoors; ++k) {
    const double left = kBegin + kPeriod * k;
    if (k == 0)
      b.add({left, kCeiling, 0}, kX, kY, kPeriod, kHeight, kTexel, 150, part);
    else
      b.add_like_last({left, kCeiling, 0}, kX, kY);
  }
  for (int k = 0; k < kDoors; ++k) {
    const double left = kBegin + kPeriod * (k + 1);
    if (k == 0)
      b.add({left, kCeiling, -kWidth}, -kX, kY, kPeriod, kHeight, kTexel, 140, part);
    else
      b.add_like_last({left, kCeiling, -kWidth}, -kX, kY);
  }
  constexpr double kLength = kPeriod * kDoors;
  const auto bare = [](Canvas&) {};
  b.add({kBegin + kLength, kCeiling, 0}, -kZ, kY, kWidth, kHeight, 0.02, 120, bare);
  b.add({kBegin, kFloor, 0}, kX, -kZ, kLength, kWidth, 0.02, 90, bare);
  b.add({kBegin, kCeiling, -kWidth}, kX, kZ, kLength, kWidth, 0.02, 190, bare);
  return std::move(b.scene);
}

}  // namespace pf::sim
