#ifndef PLANEFOLD_CAPTURE_PLANE_COLOUR_H
#define PLANEFOLD_CAPTURE_PLANE_COLOUR_H

#include <cmath>
#include <cstdint>

namespace pf::capture {

struct PlaneColour {
  double r, g, b;
};

constexpr PlaneColour of_bytes(int r, int g, int b) { return {r / 255.0, g / 255.0, b / 255.0}; }

/// What a plane is to gravity, with its colour in the film and on the map. People with red-green blindness can tell them apart
/// (tests/sim/test_plane_classes.py).
struct PlaneClass {
  const char* orientation;  ///< PlaneView::orientation
  const char* name;         ///< in the legend
  PlaneColour colour;
};
constexpr PlaneClass kPlaneClasses[] = {{"vertical", "wall", of_bytes(0x85, 0x6b, 0xff)},
                                        {"horizontal_up", "floor, table", of_bytes(0xe6, 0x99, 0x00)},
                                        {"horizontal_down", "ceiling", of_bytes(0x57, 0xb5, 0xe8)},
                                        {"other", "slanted", of_bytes(0xf7, 0xed, 0x73)},
                                        {"unknown", "unknown", of_bytes(0x9e, 0x9e, 0x9e)}};

/// A colour for each number of a plane, in map.ply, and in film and map while gravity is not known; neighbouring numbers differ much.
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
