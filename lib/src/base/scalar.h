#pragma once

namespace pf {

/// What the library computes in: planefold in double, planefoldf in float.
#ifdef PLANEFOLD_SCALAR_FLOAT
using Scalar = float;
#else
using Scalar = double;
#endif

}  // namespace pf
