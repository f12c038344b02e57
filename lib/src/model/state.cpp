#include "model/state.h"

#include "base/assert.h"
#include "model/kinds.h"

namespace pf {

#define PF_INFO(Type) , Type::kInfo
const KindInfo kKindInfo[kBlockKinds] = {KindInfo() PF_KINDS(PF_INFO)};
#undef PF_INFO

std::int16_t* State::next_link(int parent, int child) {
  Block& c = block[child];
  return c.parent == parent ? &c.next_sibling : &c.next_of_second;
}

/// Into the list of a block that it has as a parent already.
void State::insert(int parent, int child) {
  std::int16_t* link = &block[parent].first_child;
  while (*link >= 0 && block[*link].owner <= block[child].owner) link = next_link(parent, *link);
  *next_link(parent, child) = *link;
  *link = static_cast<std::int16_t>(child);
  ++block[parent].children;
}

void State::take_out(int parent, int child) {
  std::int16_t* link = &block[parent].first_child;
  while (*link != child) link = next_link(parent, *link);
  *link = *next_link(parent, child);
  *next_link(parent, child) = -1;
  --block[parent].children;
}

void State::adopt(int parent, int child) {
  Block& c = block[child];
  PF_ASSERT(c.parent < 0 && c.second_parent != parent);
  c.parent = static_cast<std::int16_t>(parent);
  insert(parent, child);
}

void State::adopt_as_second(int parent, int child) {
  Block& c = block[child];
  PF_ASSERT(c.second_parent < 0 && c.parent != parent);
  c.second_parent = static_cast<std::int16_t>(parent);
  insert(parent, child);
}

void State::leave_parent(int child) {
  Block& c = block[child];
  if (c.parent < 0) return;
  take_out(c.parent, child);
  c.parent = -1;
}

void State::leave_second_parent(int child) {
  Block& c = block[child];
  if (c.second_parent < 0) return;
  take_out(c.second_parent, child);
  c.second_parent = -1;
}

void State::set_owner(int slot, int owner) {
  const int parent = block[slot].parent, second = block[slot].second_parent;
  leave_parent(slot);
  leave_second_parent(slot);
  block[slot].owner = static_cast<std::int16_t>(owner);
  if (parent >= 0) adopt(parent, slot);
  if (second >= 0) adopt_as_second(second, slot);
}

GaugeRows gauge_rows(const State& state, const Block& block) {
  GaugeRows N = GaugeRows::Zero();
  visit(block.kind, [&](auto kind) { decltype(kind)::gauge(state, block, &N); });
  return N;
}

}  // namespace pf
