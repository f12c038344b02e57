#pragma once

#include "filter/filter.h"
#include "filter_slam/planes/own_places.h"
#include "frame/frame.h"
#include "frame/settings.h"
#include "map/map.h"
#include "map/plane_majority.h"

namespace pf {

/// Revises planes some of whose points, each by itself, lie elsewhere (lib/docs/theory/planes.md, "What points say by themselves").
/// Keeps nothing; constructed where it is used.
class PlaneRevision {
 public:
  PlaneRevision(const Settings& settings, Filter& filter, Map& map, const Frame& frame, OwnPlaces& places)
      : settings_(settings), filter_(filter), map_(map), frame_(frame), places_(places) {}

  /// Points that do not lie on the plane of the others leave it, and it moves to where the others are.
  void revise(int plane_entry);

 private:
  /// Lists points of a plane (block) with what their own pixels say of where they are. Returns how many.
  int list_places(int plane, const Vec3& n_W, JudgedPoint* points, int* slots) const;
  /// A point that lies elsewhere becomes a point of its own, where its ray has the height that its pixels say.
  void leave(int plane_entry, int slot, const Vec3& p_W, const Vec3& n_W);
  /// Moves the plane to that of most of its points. Its covariance becomes that of the new plane, inflated by the step.
  void move_to(int plane_entry, const MajorityPlane& to);

  const Settings& settings_;
  Filter& filter_;
  Map& map_;
  const Frame& frame_;
  OwnPlaces& places_;
};

}  // namespace pf
