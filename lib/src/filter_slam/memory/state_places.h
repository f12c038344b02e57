#pragma once

#include <cstdint>

#include "filter/filter.h"
#include "filter_slam/features/feature_keeper.h"
#include "frame/frame.h"
#include "frame/settings.h"
#include "map/map.h"
#include "memory/place_table.h"

/// Places of the filter, and which of them are in the state (lib/docs/theory/places.md, "In the filter").

namespace pf {

class Archive;

/// A place enters the state as a reference camera with the covariance of its record, and its points as points of that camera, so that what
/// they share is a correlation. Records of several places, and one that enters again, have common errors, and no record holds their
/// correlation. The n-th entry since the state began therefore has n (n + 1) times the covariance of its record, and a point that enters
/// for the m-th time m (m + 1) times: for whatever correlation,
///
///   C <= diag(C_1 / w_1, C_2 / w_2, ...)   where  sum w_n <= 1,   w_n = 1 / (n (n + 1))
///
/// src  covariance intersection (Julier and Uhlmann 1997)
class StatePlaces {
 public:
  StatePlaces(const Settings& settings, Filter& filter, Map& map, Frame& frame, FeatureKeeper& features)
      : settings_(settings), filter_(filter), map_(map), frame_(frame), features_(features) {}

  bool layout(Arena& arena);
  void init();
  /// The map is discarded.
  void clear();
  /// Divides the weights of places by so much, where other records enter beside them.
  void share(Scalar parts) { share_ = parts; }
  /// While tracking, places up to this id enter the state: those of a loaded map, of which W is.
  void follow_up_to(std::uint32_t last) { last_loaded_ = last; }

  PlaceTable& table() { return table_; }
  const PlaceTable& table() const { return table_; }

  /// Where nothing is known of the camera: a place enters, with those of its points that a view sees. False: there is no room.
  bool try_place(int place, const CameraView& view);
  /// Those that may belong to the view of a place that has been tried enter too, as far as there is room.
  void try_near(const CameraView& view, Scalar depth);
  /// Places that were tried, and that nothing has been measured of, leave the state.
  void end_trial();
  /// After a tracked frame: places that were tried and belong to the view stay, the others leave; the nearest place of those that belong to
  /// it enters, and points that come into view; places out of reach leave.
  void follow(const CameraView& view, Scalar depth);

  void carry(Archive& archive);  ///< base/archive.h

 private:
  /// Of an entry of the table.
  struct Link {
    int camera = -1;            ///< slot of its reference camera; -1: it is not in the state
    int anchor = -1;            ///< slot of that of its inverse depths, where the camera is
    int entry = 0;              ///< number n of its entry
    std::uint32_t passed = 0;   ///< a bit for each point that has come into view since
    std::uint32_t brought = 0;  ///< a bit for each point that has come into the state by it
    int uses = 0;               ///< how often it has entered
    bool is_on_trial = false;   ///< nothing has been measured of it
  };

  void meet_state();
  bool enter(int place);
  void leave(int place);
  void take_out(int place);
  bool has_points(int place) const;
  bool bring(int place, const CameraView& view, bool may_evict);
  int bring_point(const KeptPlace& place, const PlacePoint& from, const Link& link);
  int nearest(const CameraView& view, Scalar depth, std::uint32_t last_id) const;
  Scalar distance2(int place, const CameraView& view, Scalar depth) const;

  const Settings& settings_;
  Filter& filter_;
  Map& map_;
  Frame& frame_;
  FeatureKeeper& features_;
  PlaceTable table_;
  Link* link_ = nullptr;
  int entered_ = 0, settled_ = 0;  ///< greatest n of an entry, and of one that stays
  Scalar share_ = 1;
  std::uint32_t last_loaded_ = 0;
  std::uint32_t generation_ = 0;  ///< of the filter that cameras are in
};

}  // namespace pf
