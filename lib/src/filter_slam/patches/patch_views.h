#pragma once

#include "filter/filter.h"
#include "geometry/plane.h"
#include "map/plane_table.h"
#include "track/patch_store.h"

/// Geometry of the two views of a patch: of its reference camera and of this frame.

namespace pf {

/// Fits the plane that the corners lie on.
///
/// *range  of its middle, from the camera now [m]
/// *m      n / d in the reference camera; zero where the views do not determine it
/// False where they do not determine a plane, or it is too slanted. *m may be set then.
bool fit_plane_to(const Filter& filter, const StoredPatch& patch, PlaneFit* fit, Scalar* range, Vec3* m);

/// How far the corners are on average from where they would be if the camera had only rotated since its reference [px]; negative where that
/// is not defined.
Scalar parallax_of(const Filter& filter, const StoredPatch& patch);

/// Extends the outlines of a plane that was found by the patch's corners.
void extend_plane(const Filter& filter, const StoredPatch& patch, PlaneEntry* plane);

}  // namespace pf
