#include <algorithm>

#include "filter_slam/patches/patch_keeper.h"
#include "filter_slam/patches/tuning.h"
#include "geometry/small_cholesky.h"

/// Patches against each other, where nothing else supports the pose. The first one that is taken in would have no gate but the motion's,
/// which is pixels wide: a gross one passes it, the right ones are refused behind it, and what begins in that frame has a wrong camera.

namespace pf {

using tuning::patch_keeper::kCornersGate;

/// Finds the patches that are measured before any of them is taken in. The first one tells where the others are looked for.
PatchKeeper::Witnesses PatchKeeper::find_witnesses(const Pyramid& image, const int* order, int count) {
  Witnesses found;
  const Body estimate = filter_.state().body;
  for (int k = 0; k < count && found.count < Witnesses::kMax; ++k) {
    StoredPatch* patch = &store_[order[k]];
    const int wall = wall_of(*patch);
    // One that was missed in the last frame is looked for once it is known where.
    if (patch->wait.waits() || wall < 0 || patch->status == PatchStatus::kMissed) continue;
    Sight sight;
    PlaneAlignment alignment;
    if (!expect(*patch, wall, &sight) || !is_in_view(sight) || !is_looked_for(hiding_wall(wall, sight))) continue;
    const int plane = map_.planes[wall].slot;
    if (!filter_.predict_patch(filter_.lens(), patch->block, plane, patch->reference_px, &z_) ||
        (found.count == 0 && !find_from_afar(image, *patch, &sight)) || !align(image, sight, patch, &alignment))
      continue;
    found.entry[found.count] = order[k];
    Body& near = found.near[found.count];
    set_pose(estimate);
    const bool ok = filter_.predict_patch(filter_.lens(), patch->block, plane, patch->reference_px, &z_);
    put_measured(*patch);
    if (ok && linearise_near(*patch, plane, &near)) ++found.count;
    if (found.count > 0) set_pose(found.near[0]);
  }
  set_pose(estimate);
  return found;
}

/// Whether b passes the gate behind a, and a that of the prior:
///
///   r_b|a = r_b - S_ba S_aa^-1 r_a,   S_b|a = S_bb - S_ba S_aa^-1 S_ab
bool PatchKeeper::agree(const StoredPatch& a, const StoredPatch& b, const Body& near) {
  const int wall_a = wall_of(a), wall_b = wall_of(b);
  if (!predict_near(b, map_.planes[wall_b].slot, near, &z_)) return false;
  put_measured(b);
  of_another_ = z_;
  if (!predict_near(a, map_.planes[wall_a].slot, near, &z_)) return false;
  put_measured(a);
  const Measurement both[2] = {z_.view(), of_another_.view()};
  filter_.begin_update(both, 2);
  const BlockFilter& blocks = filter_.blocks();
  SmallCholesky<8> cholesky;
  if (!cholesky.factor(blocks.innovation_of<8>(0, 0) + z_.R_gate)) return false;
  const Vec8 r_a = z_.measured - z_.predicted, weighted = cholesky.solve<1>(r_a);
  if (!(r_a.dot(weighted) < kCornersGate)) return false;
  const Mat8 S_ba = blocks.innovation_of<8>(1, 0), S_ab = S_ba.transpose();
  const Vec8 r_b = of_another_.measured - of_another_.predicted - S_ba.lazyProduct(weighted);
  const Mat8 S_b = blocks.innovation_of<8>(1, 1) + of_another_.R_gate - S_ba.lazyProduct(cholesky.solve<8>(S_ab));
  return cholesky.factor(S_b) && r_b.dot(cholesky.solve<1>(r_b)) < kCornersGate;
}

/// Where most do not agree with the first patch, puts the largest set that agrees with one of them before the others.
void PatchKeeper::put_agreeing_first(const Pyramid& image, int* order, int count) {
  const Witnesses found = find_witnesses(image, order, count);
  for (int i = 0; i < found.count; ++i) is_found_[found.entry[i]] = true;
  if (found.count < 2) return;
  unsigned best = 0;
  int most = 1;
  for (int i = 0; i < found.count && 2 * most <= found.count; ++i) {
    unsigned set = 1u << i;
    int size = 1;
    for (int j = 0; j < found.count; ++j) {
      if (j == i || !agree(store_[found.entry[i]], store_[found.entry[j]], found.near[i])) continue;
      set |= 1u << j;
      ++size;
    }
    if (size <= most) continue;
    most = size;
    best = set;
  }
  is_contested_ = most < 2;
  if ((best & 1u) != 0 || is_contested_) return;
  const auto is_outside = [&](int entry) {
    for (int i = 0; i < found.count; ++i)
      if (found.entry[i] == entry) return (best >> i & 1u) == 0;
    return false;
  };
  // In place, and in order on both sides.
  for (int k = 1; k < count; ++k)
    for (int at = k; at > 0 && is_outside(order[at - 1]) && !is_outside(order[at]) && !store_[order[at]].wait.waits();
         --at)
      std::swap(order[at - 1], order[at]);
}

}  // namespace pf
