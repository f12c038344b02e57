#pragma once

#include "base/scalar.h"

namespace pf {

/// The question whether a feature lies on a plane: ln p(s | on the plane) / p(s | somewhere along its ray), of what is known of how far
/// from the plane it is:
///
///   on the plane   s ~ N(0, v + t²)       v  variance of s;  t  sigma of the plane's own place, with its roughness
///   somewhere      s ~ N(0, v + w²)       w  sigma of a depth of which nothing is known
///
/// What is not known says nothing: where v is large against both, the two explain s equally well, 0. So a point that passes any gate of
/// standard deviations, since it or the plane there is uncertain, is no member yet (lib/docs/theory/planes.md).
Scalar log_odds_on_plane(Scalar s, Scalar v, Scalar t, Scalar w);

}  // namespace pf
