#include "sim/scene.h"

namespace pf::sim {

Scene make_checker(double square, int squares) {
  Scene scene;
  // 64 texels a square: corners fall on texel borders.
  Canvas canvas(square * squares, square * squares, square / 64, 128);
  paint_checker(canvas, square, 40, 215);
  const double half = 0.5 * square * squares;
  scene.quads.push_back({{-half, -half, 0},
                         {1, 0, 0},
                         {0, 1, 0},
                         2 * half,
                         2 * half,
                         std::make_shared<Texture>(canvas),
                         Shape::kRectangle});
  return scene;
}

}  // namespace pf::sim
