#pragma once

#include "filter/filter.h"
#include "track/patch_store.h"

/// Prediction of a patch's corners at another pose than the estimate, where that is far from it.

namespace pf {

/// Moves the estimate's rotation and position to this pose; all else stays.
void set_camera_pose(Filter& filter, const Body& pose);

/// Prediction of a patch's corners for the estimate, linearised at another pose: h(x) + H (x^ [-] x). plane: a block. The estimate is the
/// same afterwards. False where a corner does not project.
bool predict_patch_near(Filter& filter, const StoredPatch& patch, int plane, const Body& near, PatchMeasurement* z);

/// Prediction and Jacobian of a patch that is far from where it was expected, at the pose that the prior and its corners make most likely:
///
///   z = h(x_k) + H (x [-] x_k),   x_k+1 = x^ [+] P H^T (H P H^T + R)^-1 (z - h(x_k) - H (x^ [-] x_k))      over the pose alone
///
/// so that the prediction at the estimate is h(x_k) + H (x^ [-] x_k). *near gets x_k. z has the measured corners and R_gate.
/// src  Bell and Cathey 1993
bool linearise_patch_near(Filter& filter, const StoredPatch& patch, int plane, PatchMeasurement* z, Body* near);

}  // namespace pf
