#include "model/carry.h"

#include "model/state.h"

namespace pf {
namespace {

void carry_block(Archive& archive, Block& block, int slots, int max_planes) {
  const auto slot = [&](std::int16_t& link) { archive.within(link, -1, slots - 1); };
  auto& [kind, pins, size, parent, second_parent, children, owner, first_child, next_sibling, next_of_second, frame,
         value] = block;
  archive.within(kind, 0, kBlockKinds - 1);
  if (archive.is_reading() && kind == BlockKind::kNone) block = Block();
  if (kind == BlockKind::kNone) return;
  archive.any(pins);
  archive.within(size, 0, Block::kMaxRows);
  archive.within(children, 0, slots);
  archive.within(owner, -1, INT16_MAX);
  archive.within(frame, -1, max_planes - 1);
  slot(parent), slot(second_parent), slot(first_child), slot(next_sibling), slot(next_of_second);
  archive.numbers(value);
}

/// The kind of the block that a block's coordinates are in.
BlockKind kind_of_parent(BlockKind kind) {
  switch (kind) {
    case BlockKind::kInverseDepth:
      return BlockKind::kAnchor;
    case BlockKind::kPlanePoint:
    case BlockKind::kPointGroup:
      return BlockKind::kPlane;
    case BlockKind::kGroupedPoint:
      return BlockKind::kPointGroup;
    case BlockKind::kPatchCorners:
      return BlockKind::kReferenceCamera;
    default:
      return BlockKind::kNone;
  }
}

/// The list of a block's children has all of them, and ends.
bool has_its_children(const State& state, int slot) {
  const Block* const block = state.block;
  int count = 0, last = -1;
  for (int c = block[slot].first_child; c >= 0; c = block[c].next_sibling) {
    if (count == block[slot].children || block[c].parent != slot || block[c].owner < last) return false;
    last = block[c].owner;
    ++count;
  }
  return count == block[slot].children;
}

bool is_block(const State& state, int slot) {
  const Block& block = state.block[slot];
  const BlockKind above = kind_of_parent(block.kind);
  const bool has_parent = block.parent >= 0 ? state.block[block.parent].kind == above && above != BlockKind::kNone
                                            : above == BlockKind::kNone;
  const bool has_rows =
      block.size == info(block.kind).rows || (block.size == 0 && block.kind == BlockKind::kGroupedPoint);
  return has_parent && has_rows && block.second_parent < 0 && block.next_of_second < 0 &&
         is_plane(block.kind) == (block.frame >= 0) && has_its_children(state, slot);
}

/// Whether blocks and their links are such as the functions of this room make.
bool are_blocks(const State& state) {
  int children = 0, listed = 0, planes = 0;
  for (int s = 0; s < state.slots; ++s) {
    const Block& block = state.block[s];
    if (block.kind == BlockKind::kNone) continue;
    if (!is_block(state, s)) return false;
    children += block.parent >= 0 ? 1 : 0;
    listed += block.children;
    planes += is_plane(block.kind) ? 1 : 0;
    for (int other = 0; other < s && is_plane(block.kind); ++other)
      if (state.block[other].kind != BlockKind::kNone && state.block[other].frame == block.frame) return false;
  }
  return children == listed && planes == state.planes;
}

}  // namespace

/// The layout of the body and the rows of the lens are the config's.
void State::carry(Archive& archive) {
  pf::carry(archive, body);
  archive.numbers(bend.alpha_C, bend.a_C);
  archive.within(unobservable, 0, gauge::kBareCamera);
  archive.flags(metric, uses_samples);
  pf::carry(archive, mounting);
  pf::carry(archive, lens);
  archive.within(planes, 0, max_planes);
  for (int s = 0; s < slots; ++s) carry_block(archive, block[s], slots, max_planes);
  for (int s = 0; s < slots; ++s) {
    if (!is_plane(block[s].kind) || block[s].frame < 0) continue;
    pf::carry(archive, plane_frame[block[s].frame]);
    archive.numbers(plane_roughness[block[s].frame]);
  }
  if (archive.is_reading()) archive.require(are_blocks(*this) && (!metric || layout.has(BodyPart::kGravity)));
}

}  // namespace pf
