#pragma once

#include "filter/filter.h"
#include "frame/settings.h"
#include "map/map.h"

/// Points of a plane of the table: which are on it, and which may be.

namespace pf {

/// How many features are on a plane.
struct PlanePoints {
  int folded = 0;  ///< fixed ones among them
  int fixed = 0;
  int on_trial = 0;  ///< of the folded ones, those that began on the plane and are not members yet
};

/// Outline of a plane (entry of the table) in the coordinates of its frame: the part that was seen before, extended by the points that
/// are on it now, without isolated ones and those on trial. outline may be null.
PlanePoints outline_plane(const Filter& filter, const Map& map, int plane_entry, PlaneOutline* outline);

/// Extends a plane's support to a point that has been folded.
void support(const Filter& filter, Map& map, int plane_entry, int slot);

/// The rule by which points are folded into a plane: a wall has its own roughness.
FoldRule fold_rule(const Settings& settings, const PlaneEntry& plane);

/// Whether the camera sees a point inside the wall's outline, with no other wall between them. Where the point is along its ray does not
/// matter: the plan says what should be there.
bool is_before_wall(const Filter& filter, const Map& map, int plane_entry, const Vec3& p_W);

/// Whether a point is near the known part of a plane; far from it, a point lies in the plane by chance. The paper limits the distance
/// from the plane's origin instead, since it has no variance for the distance of far points; here there is one.
bool is_in_reach(const Settings& settings, const Filter& filter, const Map& map, int plane_entry, const Vec3& p_W);

/// Whether a point lies on the plane (block), by the filter's own covariance of its distance (belief/plane_membership.h). Before a wall of
/// the plan, of which it is known that it is there: whether it passes the gate of folding, at a distance that is known to distance_at.
bool lies_on(const Settings& settings, const Filter& filter, const Map& map, int plane, int slot);

}  // namespace pf
