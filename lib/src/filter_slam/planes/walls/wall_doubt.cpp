#include "filter_slam/planes/walls/wall_doubt.h"

#include "filter_slam/features/wall_rays.h"
#include "filter_slam/planes/plane_points.h"
#include "map/wall_votes.h"
#include "model/camera_at.h"

namespace pf {
void WallDoubt::judge(int plane_entry) {
  PlaneEntry& wall = map_.planes[plane_entry];
  const State& state = filter_.state();
  const Block& block = state.block[wall.slot];
  const FoldRule rule = fold_rule(settings_, wall);
  const Scalar noise = rule.roughness * rule.roughness;
  const Scalar side = plane_distance(state.frame_of(block), block.xyz(), camera_at(state, Scalar(0)).p_W);
  const CameraAt camera = camera_at(state, Scalar(0));
  WallCover cover(map_.planes, FilterPlanes{filter_, map_}, plane_entry, filter_.lens(), {camera.q_WC, camera.p_W});
  WallVotes votes;
  votes.on = outline_plane(filter_, map_, plane_entry, nullptr).folded;
  for (int i = 0; i < map_.features.capacity(); ++i) {
    Scalar d, variance;
    Mat3 covariance;
    // What is out of sight behind the wall lies on another one.
    if (!map_.features.used(i) || map_.features[i].last_seen_ns != frame_.report.t_ns) continue;
    const int slot = map_.features[i].slot;
    // A point of another plane is known well enough, and is no less on that one than here.
    const bool elsewhere = is_planar(state.block[slot].kind) && state.plane_of(slot) != wall.slot;
    if (!elsewhere && !(certain_.is_settled(i) && certain_.is_certain(i, &covariance))) continue;
    if (!is_before_wall(filter_, map_, plane_entry, filter_.point(slot))) continue;
    if (!filter_.distance(wall.slot, slot, &d, &variance)) continue;
    if (votes.add(side < Scalar(0) ? -d : d, variance + noise, rule.gate)) cover.add(filter_.point(slot));
  }
  votes.hide_most = cover.is_wide();
  if (!wall.doubted && votes.contradict(wall)) {
    settings_.hooks.say("wall ", wall.id, " rejected: ", votes.on, " points lie on it, ", votes.off, " do not (",
                        votes.behind, " behind it); ", static_cast<int>(wall.outliers), " points left it, ",
                        wall.refused / PlaneEntry::kRefusedParts, " patches were found elsewhere");
    doubt(plane_entry);
  } else if (wall.doubted && votes.uphold()) {
    wall.doubted = false;
    wall.outliers = wall.upheld = wall.refused = 0;
    settings_.hooks.say("wall ", wall.id, " accepted again: ", votes.on, " points lie on it, ", votes.off, " do not");
  }
}

void WallDoubt::doubt(int plane_entry) {
  PlaneEntry& wall = map_.planes[plane_entry];
  const int plane = wall.slot;
  const bool has_taught = filter_.state().block[plane].children > 0 || wall.refused + wall.upheld + wall.outliers > 0;
  if (has_taught && wall.prior[0] > Scalar(0)) {
    filter_.forget_prior(plane, wall.prior_covariance(), tuning::plane_doubt::kDoubtedPrior);
    for (Scalar& c : wall.prior) c = Scalar(0);
  }
  filter_.state().for_each_planar(plane, [&](int slot) {
    const int feature = filter_.state().block[slot].owner;
    if (!filter_.unfold(slot, settings_.plane_distance)) features_.drop(&feature, 1);
  });
  wall.doubted = true;
  wall.outliers = wall.upheld = wall.refused = 0;
  wall.seen = wall.support = wall.plan;
}

}  // namespace pf
