#pragma once

#include "geometry/lens.h"
#include "model/block.h"
#include "model/body.h"
#include "model/gauge.h"

/// What the filter estimates: kinds and values of blocks, and which depends on which. BlockFilter has their rows.

namespace pf {

class Archive;

/// Properties of all kinds (kinds.h), for code that does not include them.
extern const KindInfo kKindInfo[kBlockKinds];
inline const KindInfo& info(BlockKind kind) { return kKindInfo[static_cast<int>(kind)]; }
/// Planar features depend on a plane, directly or through a point group.
inline bool is_planar(BlockKind kind) { return info(kind).planar; }

/// Blocks live in slots that do not move.
struct State {
  Body body;
  Bend bend;
  BodyLayout layout;
  gauge::Set unobservable = gauge::kBareCamera;  ///< directions that no measurement constrains
  bool metric = false;                           ///< samples of the inertial unit give lengths and gravity
  /// True while the samples of the inertial unit move the body. Without them its velocity stays constant, and the rows of the gyroscope's
  /// bias are those of the angular velocity: w_B = c - b with any constant c.
  bool uses_samples = true;
  Mounting mounting;       ///< of the inertial unit
  Camera lens;             ///< present calibration
  LensRows lens_rows;      ///< of BodyPart::kLens
  Block* block = nullptr;  ///< slots
  int slots = 0;
  PlaneFrame* plane_frame = nullptr;
  Scalar* plane_roughness = nullptr;  ///< [m] standard deviation of points from each plane, as plane_frame
  int max_planes = 0;
  int planes = 0;

  const PlaneFrame& frame_of(const Block& plane) const { return plane_frame[plane.frame]; }
  Scalar roughness_of(const Block& plane) const { return plane_roughness[plane.frame]; }

  /// Whether a feature's depth is estimated as an inverse depth, since it is not known well enough for a point.
  bool has_inverse_depth(int slot) const { return block[slot].kind == BlockKind::kInverseDepth; }

  /// A free slot, or -1.
  int find_free() const {
    for (int i = 0; i < slots; ++i)
      if (block[i].kind == BlockKind::kNone) return i;
    return -1;
  }
  /// Slot of the plane that a planar feature or a point group depends on.
  int plane_of(int slot) const {
    while (block[slot].kind != BlockKind::kPlane) slot = block[slot].parent;
    return slot;
  }

  /// Makes a block without a parent a child of this one.
  void adopt(int parent, int child);
  /// Makes `parent` the second parent of a block that has none.
  void adopt_as_second(int parent, int child);
  /// Takes a block out of its parent's list; nothing where it has no parent. Its second parent stays.
  void leave_parent(int child);
  void leave_second_parent(int child);
  /// The child of the same parent behind this one, or -1.
  int next_child(int parent, int child) const {
    return block[child].parent == parent ? block[child].next_sibling : block[child].next_of_second;
  }
  /// Sets the entry of the map's table that a block belongs to.
  void set_owner(int slot, int owner);

  /// Calls f(slot) for the features that depend on a plane, directly or through its point group, by ascending owner. f may remove the block
  /// that it is given, unfold it or release it.
  template <typename F>
  void for_each_planar(int plane, F&& f) const {
    int direct = block[plane].first_child, group = -1, fixed = -1;
    for (int c = direct; c >= 0; c = next_child(plane, c))
      if (block[c].kind == BlockKind::kPointGroup) {
        group = c;
        fixed = block[c].first_child;
      }
    while (direct >= 0 || fixed >= 0) {
      const bool take_direct = fixed < 0 || (direct >= 0 && block[direct].owner <= block[fixed].owner);
      int& cursor = take_direct ? direct : fixed;
      const int slot = cursor;
      cursor = next_child(take_direct ? plane : group, slot);
      if (is_planar(block[slot].kind)) f(slot);
    }
  }

  void carry(Archive& archive);  ///< base/archive.h

 private:
  std::int16_t* next_link(int parent, int child);
  void insert(int parent, int child);
  void take_out(int parent, int child);
};

/// Gauge rows of a block (model/gauge.h), for every direction. Rows beyond the block's size are zero.
GaugeRows gauge_rows(const State& state, const Block& block);

}  // namespace pf
