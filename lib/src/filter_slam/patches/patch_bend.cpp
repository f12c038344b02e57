#include <algorithm>

#include "filter_slam/patches/patch_keeper.h"
#include "filter_slam/patches/tuning.h"
#include "geometry/small_cholesky.h"

/// A patch whose plane is far from where the filter has it: the linearisation at the estimate is bad, and counts for less.

namespace pf {

using namespace tuning::patch_bend;
using tuning::patch_keeper::kCornersGate;
using tuning::patch_keeper::kLinearReach;

/// Variance of what the linearisation leaves out where the innovation r is the plane's fault: corners move with the parallax p as with
/// 1 / depth, so r says that the depth is wrong by r / p of itself, and the rows that say so are wrong by as much: (r r / p)^2.   [px^2]
Scalar PatchKeeper::bend_of(const StoredPatch& patch) const {
  const Scalar parallax = std::max(parallax_of(patch), kMinParallax);
  const Scalar r2 = (z_.measured - z_.predicted).cwiseAbs2().maxCoeff();
  return r2 * r2 / (parallax * parallax);
}

/// Takes a part of the information in where the linearisation is bad, as much as it is worth there, and predicts the corners again at what
/// this leaves; z_ has the rest of it then: with B = bend I
///
///   R^-1 = (R + B)^-1 + (R + R B^-1 R)^-1
///
/// False where the rest does not pass the gate.
bool PatchKeeper::take_bent(const StoredPatch& patch, int plane) {
  for (int round = 0; round < kMaxRounds; ++round) {
    if ((z_.measured - z_.predicted).cwiseAbs().maxCoeff() > kLinearReach) break;  // linearised elsewhere
    const Scalar bend = bend_of(patch);
    if (!(bend * z_.kHeight > kMinShare * z_.R_update.trace())) break;
    const Mat8 R = z_.R_update, R_gate = z_.R_gate;
    const Vec8 measured = z_.measured;
    z_.R_update += bend * Mat8::Identity();
    const Measurement part = z_.view();
    filter_.begin_update(&part, 1);
    const bool done = filter_.finish_update(&part, 1, nullptr, nullptr);
    tracking_.note_update(done);
    if (!done || !filter_.predict_patch(filter_.lens(), patch.block, plane, patch.reference_px, &z_)) return false;
    z_.measured = measured;
    z_.R_gate = R_gate;
    z_.R_update = R + R.lazyProduct(R) / bend;
    SmallCholesky<8> cholesky;
    const Vec8 r = z_.measured - z_.predicted;
    if (!cholesky.factor(filter_.covariance_of<8>(z_.H) + z_.R_update)) return false;
    if (!(r.dot(cholesky.solve<1>(r)) < kCornersGate)) return false;
  }
  return true;
}

}  // namespace pf
