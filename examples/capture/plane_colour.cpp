#include "plane_colour.h"

#include <cstring>
#include <iterator>

#include "view.h"

namespace pf::capture {

PlaneColour colour_of_plane(const FrameView& view, uint32_t id) {
  if (!view.has_gravity) {
    return plane_colour(id);
  }
  const char* orientation = "unknown";
  for (const PlaneView& plane : view.planes) {
    if (plane.id == id) orientation = plane.orientation;
  }
  for (const PlaneClass& one : kPlaneClasses) {
    if (std::strcmp(one.orientation, orientation) == 0) return one.colour;
  }
  return std::end(kPlaneClasses)[-1].colour;
}

}  // namespace pf::capture
