#include "filter_slam/patches/patch_consensus.h"

#include <algorithm>

#include "filter_slam/patches/patch_linearisation.h"
#include "filter_slam/patches/patch_sight.h"
#include "filter_slam/patches/patch_walls.h"
#include "filter_slam/patches/tuning.h"
#include "geometry/small_cholesky.h"

namespace pf {

bool PatchConsensus::find(const Pyramid& image, int wall, bool is_first, StoredPatch* patch) {
  PatchSight sight;
  if (!expect_patch(filter_, map_.planes, *patch, wall, &sight) || !is_in_view(filter_.lens(), sight)) return false;
  const int hiding = hiding_wall(filter_, map_, wall, sight);
  if (hiding >= 0 && !is_known_by_plan_alone(filter_, map_.planes[hiding])) return false;
  return update_.predict(*patch, wall) && (!is_first || finder_.search(image, *patch, update_.measurement(), &sight)) &&
         finder_.align(image, sight, patch);
}

PatchConsensus::Witnesses PatchConsensus::find_witnesses(const Pyramid& image, const int* order, int count) {
  Witnesses found;
  const Body estimate = filter_.state().body;
  for (int k = 0; k < count && found.count < Witnesses::kMax; ++k) {
    StoredPatch* patch = &store_[order[k]];
    const int wall = wall_of(map_.planes, *patch);
    // One that was missed in the last frame is looked for once it is known where.
    if (patch->wait.waits() || wall < 0 || patch->status == PatchStatus::kMissed) continue;
    if (!find(image, wall, found.count == 0, patch)) continue;
    found.entry[found.count] = order[k];
    set_camera_pose(filter_, estimate);
    if (update_.find_pose(*patch, wall, &found.near[found.count])) ++found.count;
    if (found.count > 0) set_camera_pose(filter_, found.near[0]);
  }
  set_camera_pose(filter_, estimate);
  return found;
}

bool PatchConsensus::are_consistent(const StoredPatch& a, const StoredPatch& b, const Body& near) {
  using Mat8 = PatchMeasurement::Matrix;
  using Vec8 = PatchMeasurement::Vector;
  const PatchMeasurement& z = update_.measurement();
  if (!update_.predict_measured_near(b, wall_of(map_.planes, b), near)) return false;
  of_another_ = z;
  if (!update_.predict_measured_near(a, wall_of(map_.planes, a), near)) return false;
  const Measurement both[2] = {z.view(), of_another_.view()};
  filter_.begin_update(both, 2);
  const BlockFilter& blocks = filter_.blocks();
  SmallCholesky<8> cholesky;
  if (!cholesky.factor(blocks.innovation_of<8>(0, 0) + z.R_gate)) return false;
  const Vec8 r_a = z.measured - z.predicted, weighted = cholesky.solve<1>(r_a);
  if (!(r_a.dot(weighted) < update_.gate())) return false;
  const Mat8 S_ba = blocks.innovation_of<8>(1, 0), S_ab = S_ba.transpose();
  const Vec8 r_b = of_another_.measured - of_another_.predicted - S_ba.lazyProduct(weighted);
  const Mat8 S_b = blocks.innovation_of<8>(1, 1) + of_another_.R_gate - S_ba.lazyProduct(cholesky.solve<8>(S_ab));
  return cholesky.factor(S_b) && r_b.dot(cholesky.solve<1>(r_b)) < update_.gate();
}

unsigned PatchConsensus::largest_set(const Witnesses& found, int* size) {
  unsigned best = 0;
  *size = 1;
  for (int i = 0; i < found.count && 2 * *size <= found.count; ++i) {
    unsigned set = 1u << i;
    int members = 1;
    for (int j = 0; j < found.count; ++j) {
      if (j == i || !are_consistent(store_[found.entry[i]], store_[found.entry[j]], found.near[i])) continue;
      set |= 1u << j;
      ++members;
    }
    if (members <= *size) continue;
    *size = members;
    best = set;
  }
  return best;
}

void PatchConsensus::put_consistent_first(const Pyramid& image, int* order, int count) {
  const Witnesses found = find_witnesses(image, order, count);
  for (int i = 0; i < found.count; ++i) found_ |= 1u << found.entry[i];
  if (found.count < 2) return;
  int size = 0;
  const unsigned best = largest_set(found, &size);
  is_contested_ = size < 2;
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
