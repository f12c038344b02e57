#pragma once

#include <cstdint>

#include "filter/filter.h"
#include "filter_slam/features/feature_keeper.h"
#include "frame/frame.h"
#include "frame/settings.h"
#include "map/map.h"
#include "memory/place_table.h"

/// Makes places of what the filter tracks (lib/docs/theory/places.md, "In the filter").

namespace pf {

class Archive;

/// Where the view differs from that of every place, a copy of the camera joins the state. It becomes a place when the view has left it, so
/// that its points are as well known as they have become until then.
class PlaceMaker {
 public:
  PlaceMaker(const Settings& settings, Filter& filter, Map& map, Frame& frame, FeatureKeeper& features,
             PlaceTable& places)
      : settings_(settings), filter_(filter), map_(map), frame_(frame), features_(features), places_(places) {}

  void init() { data_ = Data(); }
  /// The place that was begun is dropped, as when lengths change or the map is discarded.
  void drop();
  /// Ids up to this one are not given out.
  void number_from(std::uint32_t last) { data_.last_id = data_.last_id > last ? data_.last_id : last; }

  /// After a tracked frame. depth: median, of what is seen. scratch: for one place.
  void follow(const CameraView& view, Scalar depth, KeptPlace* scratch);
  /// The place that was begun, as its camera and points are known now. False: there is none, or it has too few points.
  bool make(KeptPlace* out) const;

  void carry(Archive& archive);  ///< base/archive.h

 private:
  struct Data {
    int camera = -1;               ///< slot of the copy; -1: no place was begun
    std::uint32_t generation = 0;  ///< of the filter that it is in
    std::uint32_t id = 0, last_id = 0;
    Scalar depth = 1;
  };

  bool has_camera() const;
  bool is_taken(std::uint32_t id) const;
  bool make_point(int feature, PlacePoint* out) const;

  const Settings& settings_;
  Filter& filter_;
  Map& map_;
  Frame& frame_;
  FeatureKeeper& features_;
  PlaceTable& places_;
  Data data_;
};

}  // namespace pf
