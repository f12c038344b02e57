#include "filter/vertical.h"
#include "slam/plane_keeper.h"
#include "slam/tuning.h"

/// Planes that somebody says are vertical (lib/docs/inertial.md).

namespace pf {

/// How far the plane is from vertical is one constant, so that saying it again says nothing new.
Status PlaneKeeper::set_vertical(int plane_entry, Scalar sigma) {
  using namespace tuning::plane_vertical;
  PlaneEntry& plane = map_.planes[plane_entry];
  if (sigma > Scalar(0)) {
    if (plane.vertical.is_told()) return Status::kOk;
    if (!take_vertical(filter_, plane.slot, sigma, kVerticalGate, &plane.vertical)) return Status::kRange;
  } else if (plane.vertical.is_told()) {
    const VerticalRow gone = plane.vertical;
    forget_vertical(filter_, plane.slot, gone);
    plane.vertical = VerticalRow();
    for (int i = 0; i < map_.planes.capacity(); ++i)
      if (map_.planes.used(i) && map_.planes[i].vertical.is_told()) allow_for_forgotten(gone, &map_.planes[i].vertical);
  }
  return Status::kOk;
}

}  // namespace pf
