#include "belief/plane_membership.h"

#include <cmath>

namespace pf {

Scalar log_odds_on_plane(Scalar s, Scalar v, Scalar t, Scalar w) {
  const Scalar on = v + t * t, somewhere = v + w * w;
  return Scalar(0.5) * (std::log(somewhere / on) - s * s * (1 / on - 1 / somewhere));
}

}  // namespace pf
