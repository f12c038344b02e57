#pragma once

#include "base/status.h"
#include "keyframe_slam/memory/place_keeper.h"
#include "keyframe_slam/planes/planes.h"
#include "memory/map_file.h"

/// Writes the window's map to a portable one, and begins in one (lib/docs/reference/map_format.md).

namespace pf {

class Archive;

class MapSaving {
 public:
  MapSaving(const Settings& settings, KeyframeMap& map, KeyframePlanes& planes, const PlaceKeeper& keeper)
      : settings_(settings), map_(map), planes_(planes), keeper_(keeper) {}

  bool layout(Arena& arena);

  /// Writes the map that has this id. Changes nothing but scratch. kNothing: there is no place worth keeping; nothing is written.
  Status save(const Vec3& gravity_W, std::uint32_t map_id, MapWriter* out) const;
  /// Puts a map that was opened into empty tables. kFull: it has more planes, places or anchors than these hold; nothing has changed.
  Status load(const SavedMap& saved, std::uint32_t map_id);

  void init() { is_loaded_ = false; }
  /// The map of the window is a loaded one.
  bool is_loaded() const { return is_loaded_; }
  /// Room for one place, within one call.
  KeptPlace* scratch() const { return keeper_.scratch(); }

  void carry(Archive& archive);  ///< base/archive.h

 private:
  /// What a place is made of: one of the table, or a keyframe.
  struct Source {
    std::uint32_t id;
    std::int16_t place, keyframe;  ///< entries; -1: not this one
    std::int16_t points;
    bool chosen;
    Scalar depth;
    Quat q_WK;
    Vec3 p_WK;
  };

  int list_sources() const;
  void thin_out(int count) const;
  void write_planes(MapWriter* out) const;
  void write_places(int count, MapWriter* out) const;
  Anchor held_by_chosen(const Anchor& anchor, int count) const;

  const Settings& settings_;
  KeyframeMap& map_;
  KeyframePlanes& planes_;
  const PlaceKeeper& keeper_;
  bool is_loaded_ = false;
  Source* source_ = nullptr;  ///< one for each place and keyframe
};

}  // namespace pf
