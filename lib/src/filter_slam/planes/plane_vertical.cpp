#include "filter/vertical.h"
#include "filter_slam/planes/plane_keeper.h"
#include "filter_slam/planes/tuning.h"

/// Planes that somebody says are vertical (lib/docs/inertial.md).

namespace pf {

/// What was told of a plane, in the map as it is.
VerticalRow* PlaneKeeper::told_row(int plane_entry) {
  Told& told = told_[plane_entry];
  const std::uint32_t id = map_.planes[plane_entry].id, generation = filter_.generation();
  if (told.id != id || told.generation != generation) told = {id, generation, VerticalRow()};
  return &told.row;
}

/// How far the plane is from vertical is one constant, so that saying it again says nothing new.
Status PlaneKeeper::set_vertical(int plane_entry, Scalar sigma) {
  using namespace tuning::plane_vertical;
  VerticalRow* const told = told_row(plane_entry);
  const int slot = map_.planes[plane_entry].slot;
  if (sigma > Scalar(0)) {
    if (told->is_told()) return Status::kOk;
    if (!take_vertical(filter_, slot, sigma, kVerticalGate, told)) return Status::kRange;
  } else if (told->is_told()) {
    const VerticalRow gone = *told;
    forget_vertical(filter_, slot, gone);
    *told = VerticalRow();
    for (int i = 0; i < map_.planes.capacity(); ++i)
      if (map_.planes.used(i) && told_row(i)->is_told()) allow_for_forgotten(gone, told_row(i));
  }
  return Status::kOk;
}

}  // namespace pf
