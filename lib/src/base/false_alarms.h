#pragma once

#include "base/scalar.h"

namespace pf {

/// ln of the expected number of planes as good as this one that chance makes out of points without any plane:
///
///   NFA = C(around, 3) P(X >= on - 3),    X ~ Binomial(near - 3, share)
///
/// on       points within a small distance of the plane, the three of its minimal set among them
/// near     points within a larger distance of it, on <= near
/// share    of the larger layer that the small one fills, in (0, 1)
/// around   points that minimal sets are drawn from, >= 3
/// 0 when on < 4
/// src      a-contrario detection (Desolneux, Moisan and Morel 2000), applied to planes
Scalar log_false_alarms(int on, int near, Scalar share, int around);

}  // namespace pf
