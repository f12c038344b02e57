#pragma once

#include "base/status.h"
#include "filter_slam/memory/place_maker.h"
#include "filter_slam/memory/state_places.h"
#include "filter_slam/pose/proposed_poses.h"
#include "frame/pose_hypotheses.h"
#include "memory/map_file.h"
#include "memory/place_recall.h"

/// What the filter keeps of places: it makes them, saves a map of them, begins in one, and finds itself there (lib/docs/theory/places.md,
/// "In the filter").

namespace pf {

class Archive;

class FilterMemory {
 public:
  FilterMemory(const Settings& settings, Filter& filter, Map& map, Frame& frame, FeatureKeeper& features)
      : settings_(settings),
        filter_(filter),
        map_(map),
        places_(settings, filter, map, frame, features),
        maker_(settings, filter, map, frame, features, places_.table()),
        rivals_(settings, filter) {}

  bool layout(Arena& arena);
  void init();
  /// The map is discarded, or its lengths have changed.
  void clear();

  /// Writes the map that has this id. Changes nothing but scratch. kNothing: there is no place; nothing is written.
  Status save(const Vec3& gravity_W, std::uint32_t map_id, MapWriter* out) const;

  /// Puts a map that was opened into empty tables and an empty state. kFull: it has more planes, places or anchors than these hold, or more
  /// rows; nothing has changed.
  Status load(const SavedMap& saved, std::uint32_t map_id);
  /// The map is a loaded one, and the camera has been found in it.
  bool is_loaded() const { return is_loaded_; }
  bool is_found() const { return is_found_; }

  /// Lost in a loaded map: the place that the image may show enters the state on trial, and its rival, which has_rival says there is.
  /// False: there is none.
  bool recall(const Tracker& tracker, PoseHypothesis* place, PoseHypothesis* rival, bool* has_rival);
  /// Poses of the second best places.
  ProposedPoses& rivals() { return rivals_; }
  /// Whether enough of the place was found where it was recalled.
  void note_tried(bool found) { recalled_in_vain_ = is_recalled_ && !found; }
  /// After a tracked frame. depth: of what is seen, median; in the first one of a loaded map it is not known yet.
  void follow(const CameraView& view, Scalar depth);

  const PlaceTable& table() const { return places_.table(); }
  /// Room for one place, within one call.
  KeptPlace* scratch() const { return scratch_; }

  void carry(Archive& archive);  ///< base/archive.h

 private:
  /// A plane as its map had it.
  struct PlaneRecord {
    std::uint32_t id = 0;
    Mat3 covariance = Mat3::Zero();
  };

  void write_planes(MapWriter* out) const;
  int write_places(MapWriter* out) const;
  Anchor held_by_place(const Anchor& anchor, int left_out) const;
  void restore_plane(const SavedPlane& plane, Scalar parts);
  void restore_anchor(const Anchor& anchor, std::uint32_t map_id);

  const Settings& settings_;
  Filter& filter_;
  Map& map_;
  StatePlaces places_;
  PlaceMaker maker_;
  PlaceRecall recall_;
  ProposedPoses rivals_;
  KeptPlace* scratch_ = nullptr;
  PlaneRecord* record_ = nullptr;  ///< as the table of planes
  Scalar depth_ = 1;               ///< of what is seen, median, as it was recalled last
  bool is_loaded_ = false, is_found_ = false;
  bool is_recalled_ = false, recalled_in_vain_ = false;  ///< in the last frame that recall() was called in
};

}  // namespace pf
