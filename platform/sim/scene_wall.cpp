#include "sim/scene_builder.h"

namespace pf::sim {

Scene make_wall(Random& random, const SceneOptions& options) {
  Builder b(random, options);
  b.add({-2.5, -1.8, 0}, {1, 0, 0}, {0, 1, 0}, 5.0, 3.6, 0.002, 135, [&](Canvas& c) {
    b.clutter(c, 0.2, 75);
    if (options.target) b.paint_target(c, 2.5, 1.8);
  });
  if (options.person) b.add_person({-1.6, -0.7, -0.4}, {0.25, 0, 0}, {1, 0, 0}, 0.8);
  return std::move(b.scene);
}

}  // namespace pf::sim
