#pragma once

#include <cstdint>

#include "base/arena.h"
#include "base/parts.h"
#include "base/small_count.h"
#include "base/table_entries.h"
#include "geometry/plane.h"
#include "map/plane_outline.h"

/// Table of planes: the data of each beside its block in the filter.

namespace pf {

class Archive;

/// A wall: a plane known beforehand, with how uncertain it is.
struct PlanePrior {
  PlaneFrame frame;                ///< third axis towards the side that can be seen, origin at the wall's own centre
  Mat3 covariance = Mat3::Zero();  ///< of (alpha, beta, delta) at that origin, see plane_error_jacobian
  PlaneOutline outline;            ///< in that frame
  Scalar roughness = 0;            ///< [m] 0: that of the settings
  bool two_sided = false;          ///< can be seen from both sides
};

struct PlaneEntry {
  std::uint32_t id = 0;   ///< never used twice
  int slot = -1;          ///< block in the filter; -1: this entry is free
  SmallCount age;         ///< frames since it was found
  SmallCount weak;        ///< of these, the last ones in a row with too few points
  SmallCount max_points;  ///< most points that it had at one time
  SmallCount outliers;    ///< points that were unfolded because they do not lie on it
  SmallCount upheld;      ///< patches that were measured on it for long
  SmallCount refused;     ///< patches that were dropped because they were found elsewhere, in parts (refuse())
  PlaneOutline seen;  ///< of points that were on it when it was last tended to, many of them gone from the map since
  PartSwitch<kHasWalls> known;  ///< a wall: known beforehand, and never dissolved
  bool doubted = false;         ///< a wall that is rejected by its gate; it takes no points
  PartSwitch<kHasWalls>
      apart;  ///< a wall that nothing in the map has been compared with yet, since the scale is not known
  bool two_sided = false;
  bool remembered = false;  ///< of a loaded map: stays while none of its points are with the back end
  Scalar roughness = 0;     ///< [m] of its surface
  Scalar prior[6] = {};     ///< of a wall: covariance of (a, b, h), lower triangle; zero: it no longer counts
  PlaneOutline plan;        ///< of a wall, as it was given
  PlaneOutline support;  ///< of all points that it was found by or that ever joined it, in the coordinates of its frame

  /// Whether points and patches may lie on it, and it hides what is behind it.
  bool counts() const { return !doubted && !apart; }
  /// Of a wall whose prior counts.
  Mat3 prior_covariance() const {
    Mat3 covariance;
    for (int i = 0, k = 0; i < 3; ++i)
      for (int j = 0; j <= i; ++j) covariance(i, j) = covariance(j, i) = prior[k++];
    return covariance;
  }

  static constexpr int kOutlierShare = 4;  ///< one in so many
  static constexpr int kRefusedParts = 4;  ///< of a patch that is found behind a wall; before it: one
  static constexpr int kUpheldWorth = 8;   ///< points that a patch counts as which was measured on it for long
  /// A patch of it was found elsewhere. A patch behind a wall is evidence that the wall is not at its place. One before it may be on an
  /// obstacle and counts only in part: many of these mean that nothing of the wall is seen.
  void refuse(bool is_before) { refused = refused + (is_before ? 1 : kRefusedParts); }
  /// Whether patches reject the wall's place. Obstacles before a wall at its right place cause some rejections, too.
  bool is_refused_by_patches() const {
    constexpr int kMinRefused = 3, kShare = 4;
    const int patches = refused / kRefusedParts;
    return patches >= kMinRefused && patches > kShare * upheld;
  }
  /// Whether points that nothing else is known of may begin on it: it was found, has had enough points for kProvenAge frames, and most
  /// kept to it.
  bool is_proven(int min_points) const {
    constexpr int kProvenAge = 10;
    return !known && age >= kProvenAge && weak == 0 && max_points > min_points &&
           kOutlierShare * outliers <= max_points;
  }
};

class PlaneTable {
 public:
  bool layout(Arena& arena, int capacity) {
    entry_ = arena.take<PlaneEntry>(static_cast<std::size_t>(capacity));
    merged_ = arena.take<Merged>(static_cast<std::size_t>(capacity) * kMergesPerPlane);
    capacity_ = capacity;
    return arena.ok();
  }
  void init() {
    clear();
    next_id_ = 1;
  }
  /// Removes all planes. Their ids are not used again.
  void clear() {
    for (int i = 0; i < capacity_; ++i) entry_[i] = PlaneEntry();
    for (int i = 0; i < capacity_ * kMergesPerPlane; ++i) merged_[i] = Merged();
    next_merged_ = 0;
  }

  /// Removes planes that were found. Walls are what they were when they came, but for their blocks.
  void keep_known() {
    for (int i = 0; i < capacity_; ++i) {
      const PlaneEntry was = entry_[i];
      entry_[i] = PlaneEntry();
      if (was.slot < 0 || !was.known) continue;
      entry_[i].id = was.id;
      entry_[i].slot = was.slot;
      entry_[i].known = true;
      entry_[i].apart = was.apart;
      entry_[i].two_sided = was.two_sided;
      entry_[i].roughness = was.roughness;
      for (int k = 0; k < 6; ++k) entry_[i].prior[k] = was.prior[k];
      entry_[i].plan = entry_[i].seen = entry_[i].support = was.plan;
    }
    for (int i = 0; i < capacity_ * kMergesPerPlane; ++i) merged_[i] = Merged();
    next_merged_ = 0;
  }

  int capacity() const { return capacity_; }
  bool used(int i) const { return entry_[i].slot >= 0; }
  PlaneEntry& operator[](int i) { return entry_[i]; }
  const PlaneEntry& operator[](int i) const { return entry_[i]; }

  /// Entry of a new plane, or -1 when the table is full.
  int add(int slot) {
    for (int i = 0; i < capacity_; ++i) {
      if (used(i)) continue;
      entry_[i] = PlaneEntry();
      entry_[i].slot = slot;
      entry_[i].id = next_id_++;
      return i;
    }
    return -1;
  }
  /// Entry of a plane of a loaded map, under its own id, or -1 when the table is full. It is not dissolved when it has few points.
  int restore(std::uint32_t id) {
    const int i = add(0);
    if (i < 0) return -1;
    entry_[i].id = id;
    entry_[i].remembered = true;
    next_id_ = (next_id_ - 1 > id ? next_id_ - 1 : id) + 1;
    return i;
  }
  void remove(int i) { entry_[i] = PlaneEntry(); }
  bool has_known() const {
    if (!kHasWalls) return false;
    for (int i = 0; i < capacity_; ++i)
      if (used(i) && entry_[i].known) return true;
    return false;
  }
  bool has_apart() const {
    if (!kHasWalls) return false;
    for (int i = 0; i < capacity_; ++i)
      if (used(i) && entry_[i].apart) return true;
    return false;
  }
  /// Clears the evidence of patches against walls.
  void forget_refusals() {
    for (int i = 0; i < capacity_; ++i) entry_[i].refused = 0;
  }
  void remember_merge(std::uint32_t from, std::uint32_t into) {
    merged_[next_merged_] = {from, into};
    next_merged_ = (next_merged_ + 1) % (capacity_ * kMergesPerPlane);
  }

  /// Entry of the plane in this block, or -1.
  int entry_at(int slot) const {
    for (int i = 0; i < capacity_; ++i)
      if (used(i) && entry_[i].slot == slot) return i;
    return -1;
  }
  /// Entry of the plane with this id, or -1.
  int entry_of(std::uint32_t id) const { return entry_with_id(*this, id); }
  /// Id of the plane in this block, or 0.
  std::uint32_t id_at(int slot) const {
    const int entry = entry_at(slot);
    return entry < 0 ? 0 : entry_[entry].id;
  }
  /// Current id of a plane that may have been merged; 0 if it is gone, or its merge is no longer remembered.
  std::uint32_t find(std::uint32_t id) const {
    for (int step = 0; step <= capacity_ * kMergesPerPlane; ++step) {
      if (entry_of(id) >= 0) return id;
      std::uint32_t next = 0;
      for (int i = 0; i < capacity_ * kMergesPerPlane; ++i)
        if (merged_[i].from == id && id != 0) next = merged_[i].into;
      if (next == 0) return 0;
      id = next;
    }
    return 0;
  }

  void carry(Archive& archive, int slots);  ///< base/archive.h; slots: of blocks

 private:
  static constexpr int kMergesPerPlane = 4;  ///< merges, per plane of the capacity
  struct Merged {
    std::uint32_t from = 0, into = 0;
  };

  PlaneEntry* entry_ = nullptr;
  Merged* merged_ = nullptr;
  int capacity_ = 0;
  int next_merged_ = 0;
  std::uint32_t next_id_ = 1;
};

}  // namespace pf
