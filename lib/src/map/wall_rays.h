#pragma once

#include "map/plane_table.h"

/// Where rays meet the walls of a plan. `where(entry)` is the PlaneAt of a plane of the table, by the back end.

namespace pf {

/// A plane where it is: (a, b, h) about its frame.
struct PlaneAt {
  PlaneFrame frame;
  Vec3 x = Vec3::Zero();
};

/// Whether a ray from origin_W meets a wall inside of an outline of it, on a side that can be seen. *range is from the origin, in lengths
/// of the direction; untouched where it does not.
bool meets_outline(const PlaneAt& at, bool two_sided, const PlaneOutline& outline, const Vec3& origin_W,
                   const Vec3& direction_W, Scalar* range);

/// The first wall that a ray meets, not counting rejected ones; -1: none. *range as above.
template <class Where>
int find_first_wall(const PlaneTable& planes, const Where& where, const Vec3& origin_W, const Vec3& direction_W,
                    Scalar* range) {
  int first = -1;
  for (int k = 0; k < planes.capacity(); ++k) {
    Scalar at = 0;
    if (!planes.used(k) || !planes[k].known || !planes[k].counts()) continue;
    if (!meets_outline(where(k), planes[k].two_sided, planes[k].support, origin_W, direction_W, &at)) continue;
    if (first >= 0 && at >= *range) continue;
    first = k;
    *range = at;
  }
  return first;
}

/// Whether a camera at c_W sees a point through the outline of this wall, rejected or not, with no other wall before it.
template <class Where>
bool sees_through_outline(const PlaneTable& planes, const Where& where, int wall, const Vec3& c_W, const Vec3& p_W) {
  Scalar range = 0, nearest = 0;
  if (!meets_outline(where(wall), planes[wall].two_sided, planes[wall].support, c_W, p_W - c_W, &range)) return false;
  const int first = find_first_wall(planes, where, c_W, p_W - c_W, &nearest);
  return first < 0 || first == wall || range <= nearest;
}

/// Distance along a ray to the nearest wall of the plan, in lengths of direction_W; zero where it has none there. plan_of(entry): the frame
/// in which the plan has a wall, rejected or not.
template <class PlanOf>
Scalar find_range_in_plan(const PlaneTable& planes, const PlanOf& plan_of, const Vec3& origin_W,
                          const Vec3& direction_W) {
  Scalar nearest = 0;
  for (int k = 0; k < planes.capacity(); ++k) {
    Scalar at = 0;
    if (!planes.used(k) || !planes[k].known) continue;
    if (!meets_outline({plan_of(k)}, planes[k].two_sided, planes[k].plan, origin_W, direction_W, &at)) continue;
    if (nearest == Scalar(0) || at < nearest) nearest = at;
  }
  return nearest;
}

/// The factor u on lengths about c0_W with which a point f that a camera at c_W sees would lie on a wall through o with the normal n:
///
///   u = n . (o - c0) / n . (f - c0)
///
/// Zero where that is outside of the plan's outline, or on a side that cannot be seen.
Scalar factor_onto_wall(const PlaneEntry& wall, const PlaneFrame& plan, const Vec3& c0_W, const Vec3& c_W,
                        const Vec3& f_W);
/// The factor that most of these have in common; zero where none has a clear majority. They are sorted.
Scalar clear_factor(Scalar* factors, int count);

}  // namespace pf
