#pragma once

#include <cstdint>

#include "filter/filter.h"
#include "map/map.h"
#include "track/patch_store.h"

/// Patches and the planes of the table that they may lie on.

namespace pf {

/// Entry of the plane that a patch lies on, which may have been merged; -1: it is gone or rejected.
int wall_of(const PlaneTable& planes, const StoredPatch& patch);

/// Whether this is a wall of the plan without members: neither points nor patches that were measured for long.
bool is_known_by_plan_alone(const Filter& filter, const PlaneEntry& wall);

/// Whether a plane's outline contains the patch's middle as its reference camera saw it; a plane that was found may be larger than its
/// outline. *range: its distance along the ray of the middle, from the reference camera [m].
bool may_lie_on(const Filter& filter, const Map& map, const StoredPatch& patch, int entry, Scalar* range);

/// Distance of the plane along the ray of the patch's middle, relative to that of the plane m = n / d, in the reference camera, which two
/// views of the patch give. False where they give none.
bool range_ratio(const Filter& filter, const Map& map, const StoredPatch& patch, const Vec3& m, int entry,
                 Scalar* ratio);

/// Whether another waiting patch is farther away that the same wall explains, while the wall is known by the plan alone: the wall's
/// distance then comes from the plan only, and patches before the wall pass its gate as well. No patch is behind a wall.
bool is_before_another(const Filter& filter, const Map& map, const PatchStore& store, const StoredPatch& patch,
                       int entry);

/// Whether the patch is nearer or farther than most points of this frame (t_ns) that are seen before a wall, while the wall is known by the
/// plan alone. The wall's distance from these points then comes from the plan only, so a patch before the wall passes the gate as well, and
/// would move the wall.
bool is_off_most_points(const Filter& filter, const Map& map, std::int64_t t_ns, const StoredPatch& patch, int entry);

/// Whether a plane that explains the patch is behind the wall that was seen there when the patch began.
bool is_seen_through(const Filter& filter, const Map& map, const StoredPatch& patch, int entry);

}  // namespace pf
