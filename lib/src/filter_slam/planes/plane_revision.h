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

  /// Points that do not lie on the plane of the others leave it, and take with them what they have taught it.
  void revise(int plane_entry);

 private:
  /// Lists points of a plane (block) with what their own pixels say of where they are. Returns how many.
  int list_places(int plane, const Vec3& n_W, JudgedPoint* points, int* slots) const;
  /// A point that lies elsewhere becomes a point of its own, where its ray has the height that its pixels say.
  void leave(int plane_entry, int slot, const Vec3& p_W, const Vec3& n_W);
  /// Moves the plane towards the majority's, and no farther than the points that are off can have bent it, by the own places of all of its
  /// points. These are placed by the poses of different times and may have drifted, and so may the plane: it becomes uncertain by the step,
  /// by how far it stays from the majority's plane, and by the variances of that.
  void straighten(int plane_entry, const MajorityPlane& to);

  const Settings& settings_;
  Filter& filter_;
  Map& map_;
  const Frame& frame_;
  OwnPlaces& places_;
};

}  // namespace pf
