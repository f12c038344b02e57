#include "filter_slam/planes/vertical_table.h"

#include "base/table_entries.h"
#include "filter_slam/planes/tuning.h"

namespace pf {

bool VerticalTable::layout(Arena& arena) {
  told_ = arena.take<Told>(static_cast<std::size_t>(map_.planes.capacity()));
  return arena.ok();
}

void VerticalTable::init() {
  for (int i = 0; told_ != nullptr && i < map_.planes.capacity(); ++i) told_[i] = Told();
}

VerticalRow* VerticalTable::row(int plane_entry) {
  Told& told = told_[plane_entry];
  const std::uint32_t id = map_.planes[plane_entry].id, generation = filter_.generation();
  if (told.id != id || told.generation != generation) told = {id, generation, VerticalRow()};
  return &told.row;
}

Status VerticalTable::tell(int plane_entry, Scalar sigma) {
  using tuning::plane_vertical::kVerticalGate;
  VerticalRow* const told = row(plane_entry);
  const int slot = map_.planes[plane_entry].slot;
  if (sigma > Scalar(0)) {
    if (told->is_told()) return Status::kOk;
    if (!take_vertical(filter_, slot, sigma, kVerticalGate, told)) return Status::kRange;
  } else if (told->is_told()) {
    const VerticalRow gone = *told;
    forget_vertical(filter_, slot, gone);
    *told = VerticalRow();
    for (const int i : used_entries(map_.planes))
      if (row(i)->is_told()) allow_for_forgotten(gone, row(i));
  }
  return Status::kOk;
}

void VerticalTable::merge(int from, int to) {
  if (told_ != nullptr && !row(to)->is_told()) *row(to) = *row(from);
}

}  // namespace pf
