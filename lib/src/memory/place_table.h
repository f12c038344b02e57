#pragma once

#include "base/arena.h"
#include "base/elapsed.h"
#include "base/table_entries.h"
#include "geometry/similarity.h"
#include "memory/place.h"

/// Table of places: as many as the config says, the least redundant ones.

namespace pf {

class Archive;

class PlaceTable {
 public:
  bool layout(Arena& arena, int capacity) {
    place_ = arena.take<KeptPlace>(static_cast<std::size_t>(capacity));
    capacity_ = capacity;
    return arena.ok();
  }
  void init() {
    clear();
    returned_ = 0;
  }
  void clear() {
    for (int i = 0; i < capacity_; ++i) place_[i] = KeptPlace();
  }
  /// Removes those of the present map.
  void clear_present() {
    for (int i = 0; i < capacity_; ++i)
      if (is_present(i)) place_[i] = KeptPlace();
  }
  /// The present map is left: its places go on as those of the map with this id.
  void leave(std::uint32_t map_id);
  /// The present map is joined to the one with this id, in whose coordinates its own places are now.
  void join(std::uint32_t map_id);

  int capacity() const { return capacity_; }
  int count() const;
  bool used(int i) const { return place_[i].id != 0; }
  bool is_present(int i) const { return used(i) && place_[i].map_id == 0; }
  /// Whether there are places of other maps.
  bool has_other() const {
    for (int i = 0; i < capacity_; ++i)
      if (used(i) && !is_present(i)) return true;
    return false;
  }
  KeptPlace& operator[](int i) { return place_[i]; }
  const KeptPlace& operator[](int i) const { return place_[i]; }
  /// Entry of the place with this id, or -1.
  int entry_of(std::uint32_t id) const { return entry_with_id(*this, id); }

  /// The entry that a place would take: a free one, or that of the one that is then most redundant; capacity(): of this one itself.
  int entry_for(const KeptPlace& place) const;
  /// Keeps a place in a free entry, or in that of the one that is then most redundant: of the two of all that are nearest to each other,
  /// the one with fewer points, the older one among equals. Where that is the new one it is not kept. Returns its entry, or -1.
  int keep(const KeptPlace& place);
  /// All of W is moved. Places of other maps are in another W.
  void move(const Similarity& T);
  /// One place is moved within W.
  static void move(const Similarity& T, KeptPlace* place);

  /// A place comes back to the window as a keyframe.
  void note_return(int i) {
    place_[i].is_back = true;
    count_frame(&returned_);
  }
  int returned() const { return returned_; }

  void carry(Archive& archive);  ///< base/archive.h

 private:
  int most_redundant(const KeptPlace& another) const;

  KeptPlace* place_ = nullptr;
  int capacity_ = 0;
  int returned_ = 0;  ///< since the beginning
};

}  // namespace pf
