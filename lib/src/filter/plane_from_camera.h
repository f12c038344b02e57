#pragma once

#include "model/rows.h"
#include "model/state.h"

namespace pf {

/// Rows of the error of a plane, (a, b, h) about its frame, as the camera sees it. The whole map may have drifted, rotated and moved by
/// (phi, t): camera and plane share that error, and it does not change the one against the other. The camera's own error gives it,
///
///   phi = dtheta,   t = dp + p x dtheta           p  the body's position
///   e   = dx - N_T t - N_R phi                    N  gauge rows of the plane
///
/// so that rows times all gauge rows of translation and rotation are zero.
RowsOf<3, 9, 2> plane_from_camera(const State& state, int plane);

}  // namespace pf
