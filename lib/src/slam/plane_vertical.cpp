#include <algorithm>
#include <cmath>

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
    if (plane.vertical_mrad != 0) return Status::kOk;
    Scalar before = 0;
    if (!take_vertical(filter_, plane.slot, sigma, kVerticalGate, &before)) return Status::kRange;
    plane.vertical_mrad =
        static_cast<std::uint8_t>(std::clamp(std::ceil(before / kTiltUnit), Scalar(1), kMaxTiltUnits));
  } else if (plane.vertical_mrad != 0) {
    forget_vertical(filter_, plane.slot, kTiltUnit * static_cast<Scalar>(plane.vertical_mrad));
    plane.vertical_mrad = 0;
  }
  return Status::kOk;
}

}  // namespace pf
