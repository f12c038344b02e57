#pragma once

#include "planefold/planefold.h"
#include "sim/linear.h"

namespace pfsim {

/// The surface normal . p = distance against the plane that is estimated for it: (alpha, beta, delta) of pf_plane_t, normalised by its
/// covariance, 3 on average when that is honest. The normals must look to the same side; negative where the covariance is none.
double normalised_plane_error(const pf_plane_t& plane, const pf::sim::Vec3& normal, double distance);

}  // namespace pfsim
