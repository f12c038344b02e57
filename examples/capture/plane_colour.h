#ifndef PLANEFOLD_CAPTURE_PLANE_COLOUR_H
#define PLANEFOLD_CAPTURE_PLANE_COLOUR_H

#include <cmath>
#include <cstdint>

namespace pf::capture {

/// A colour for each plane, the same in the film, on the map and in map.ply; neighbouring numbers differ much.
struct PlaneColour {
  double r, g, b;
};

inline PlaneColour plane_colour(uint32_t id) {
  const double hue = std::fmod(0.08 + 0.61803398875 * static_cast<double>(id), 1.0);
  const auto part = [&](double shift) {
    const double x = std::fabs(std::fmod(hue + shift, 1.0) * 6.0 - 3.0) - 1.0;
    const double pure = x < 0.0 ? 0.0 : x > 1.0 ? 1.0 : x;
    return 0.36 + 0.62 * pure;
  };
  return {part(0.0), part(2.0 / 3.0), part(1.0 / 3.0)};
}

}  // namespace pf::capture

#endif
