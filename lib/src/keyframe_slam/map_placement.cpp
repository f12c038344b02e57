#include "keyframe_slam/map_placement.h"

#include <cmath>

#include "base/table_entries.h"
#include "geometry/so3.h"
#include "keyframe_slam/adjustment/move_window.h"
#include "keyframe_slam/start/tuning.h"
#include "keyframe_slam/tracking/tuning.h"
#include "memory/tuning.h"

namespace pf {

Status MapPlacement::add_wall(const PlanePrior& prior, std::uint32_t* id) {
  if (!kHasWalls || !settings_.planes || !start_.has_place() || start_.is_in_loaded_map() || second_.given)
    return Status::kState;
  const PlaneTable& table = map_.tables().planes;
  // At a target the unit of length is known, and where walls that came before gave it.
  const bool has_unit = start_.is_at_target() || (table.has_known() && !table.has_apart());
  return walls_.add(prior, !has_unit, id);
}

void MapPlacement::begin_at_walls(Scalar* median_depth) {
  if (!kHasWalls || !map_.tables().planes.has_apart() || start_.is_at_target()) return;
  const int count = walls_.place_points(tuning::keyframe_tracking::kYoung, median_depth);
  if (count == 0) return;
  record_.init();
  walls_.meet(start_.first_covariance(), start_.first_place_W());
  settings_.hooks.say("map ", tracking_.map_id(), " begins before walls of the plan, with ", count, " points on them");
}

Mat6 MapPlacement::map_covariance(const Vec3& p_W) const {
  const KeyframeAdjustment& adjustment = mapping_.adjustment();
  Mat6 P = walls_.has_begun() ? Mat6(adjustment.shape().given_held + walls_.pose_covariance(p_W))
                              : adjustment.map_covariance();
  P.bottomRightCorner<3, 3>() += unit_.covariance_of_scale(p_W, start_.first_place_W());
  return P;
}

void MapPlacement::tend_walls(Scalar* median_depth) {
  PlaneTable& table = map_.tables().planes;
  if (!kHasWalls || !table.has_known()) return;
  if (table.has_apart()) {
    const Vec3 first_W = start_.first_place_W();
    const Scalar factor = walls_.find_factor(first_W, motion_.body().p_W);
    if (!(factor > Scalar(0))) return;
    record_.init();
    move(Similarity::about(first_W, factor), median_depth);
    walls_.meet(start_.first_covariance(), first_W);
    const std::uint32_t before = tracking_.map_id();
    rename_map();
    settings_.hooks.say("walls of the plan come into view: map ", before, " is scaled by ", fixed(factor, 3),
                        " and goes on as map ", tracking_.map_id(), " in metres");
  } else {
    if (!walls_.has_begun()) walls_.begin(start_.first_covariance(), start_.first_place_W(), 0);
    move(walls_.compare(mapping_.adjustment()), median_depth);
  }
  move(walls_.maintain(mapping_.adjustment(), motion_.view()), median_depth);
  mapping_.adjustment().set_place_covariance(walls_.pose_covariance(motion_.body().p_W));
}

void MapPlacement::scale_by_second_pose(Scalar* median_depth) {
  const SecondPose second = second_;
  if (record_.progress().pending()) return;
  const Vec3 first_W = start_.first_place_W();
  const bool is_now = second.is_frame(frame_.report.t_ns) && tracking_.is_tracked(frame_.report);
  const Vec3 at_W = is_now ? motion_.body().p_W : second.estimate_W;
  const Scalar moved = (at_W - first_W).norm();
  const Scalar scale = (second.p_W - first_W).norm() / moved;
  const Scalar now =
      map_.median_depth(motion_.body().q_WC, motion_.body().p_W);  // the record may just have been solved
  if (now > Scalar(0)) *median_depth = now;
  second_ = SecondPose();
  record_.init();
  if (!(is_now || second.estimated) || !(moved > tuning::second_pose::kMinSecondShift * *median_depth) ||
      !std::isfinite(scale)) {
    settings_.hooks.say("the second pose gives no scale: its frame was not tracked, or the camera moved too little (",
                        fixed(moved, 4), " with a median depth of ", fixed(*median_depth, 2), ")");
    return;
  }
  move(Similarity::about(first_W, scale), median_depth);
  mark_ = MarkedPose();
  settings_.hooks.say("map ", tracking_.map_id(), " is scaled by ", fixed(scale, 3),
                      ", to the distance of the second pose");
}

MapOfUnit MapPlacement::map_of_unit(Scalar median_depth) const {
  const PlaneTable& planes = map_.tables().planes;
  MapOfUnit map;
  map.is_tracked = tracking_.is_tracked(frame_.report);
  map.is_pending = record_.progress().recording;
  map.knows_scale = start_.is_at_target() || start_.is_in_loaded_map() || second_.given ||
                    (planes.has_known() && !planes.has_apart());
  map.map_id = tracking_.map_id();
  map.median_depth = median_depth;
  return map;
}

/// Where poses were given out in the old unit.
void MapPlacement::rename_map() {
  if (tracking_.state() == SlamState::kStarting) return;
  const std::uint32_t before = tracking_.map_id();
  tracking_.rename_map();
  frame_.correction.rename(before);
  map_.tables().anchors.move(before, tracking_.map_id(), Similarity());
}

void MapPlacement::scale_by_unit(const MovingSolution& solution, Scalar* median_depth) {
  const std::uint32_t before = tracking_.map_id();
  if (!unit_.is_from_motion()) {
    settings_.hooks.say("gravity and the biases of the inertial unit are known in map ", before, ", from a rest");
    return;
  }
  move(Similarity::about(Vec3::Zero(), solution.scale), median_depth);
  rename_map();
  settings_.hooks.say("map ", before, " is in metres, from ", fixed(solution.span, 1), " s of motion: scaled by ",
                      fixed(solution.scale, 3), " (sigma ", fixed(100 * solution.sigma_scale(), 1),
                      " %), gravity within ", degrees(solution.sigma_gravity()), " deg; it goes on as map ",
                      tracking_.map_id());
}

void MapPlacement::leave_metres(const char* why) {
  const std::uint32_t before = tracking_.map_id();
  rename_map();
  settings_.hooks.say("lengths of map ", before, " are no metres any more, since ", why, ": it goes on as map ",
                      tracking_.map_id());
}

/// What the recognised view may be off in the other map, all keyframes may: with the rotation about that view, and the scale away from it.
void MapPlacement::join(const MapJoin& join, Scalar* median_depth) {
  const std::uint32_t before = tracking_.map_id();
  record_.init();
  move(join.T, median_depth);
  const Vec3 at_W = join.T.of(join.view.c_W);
  const auto of_join = [&](const Vec3& p_W) {
    const Vec3 away = p_W - at_W;
    Mat6 A = Mat6::Identity();
    A.bottomLeftCorner<3, 3>() = -hat(away);
    Mat6 P = A.lazyProduct(join.covariance).lazyProduct(A.transpose());
    P.bottomRightCorner<3, 3>() += join.sigma_scale * join.sigma_scale * away * away.transpose();
    return P;
  };
  for (const int k : used_entries(map_.keyframes)) map_.keyframes[k].covariance += of_join(map_.keyframes[k].p_W);
  mapping_.adjustment().add_to_map(of_join(motion_.body().p_W));
  map_.keyframes.set_began_elsewhere();
  map_.places.join(join.map_id);
  tracking_.rename_map(join.map_id);
  frame_.correction.rename(before);
  map_.tables().anchors.move(before, join.map_id, Similarity());
  settings_.hooks.say("map ", before, " is recognised in map ", join.map_id, " and joined to it, scaled by ",
                      fixed(join.T.s, 3));
}

void MapPlacement::close_loop(const LoopClosure& loop, Scalar* median_depth) {
  const Similarity T = similarity_of(loop.x, loop.at_W);
  Mat6 covariance;
  Loops& loops = mapping_.loops();
  if (!loops.close(loop, relocaliser_.keeper().taken(), &covariance)) return;
  record_.init();
  motion_.move(T);
  frame_.correction.add(T);
  mapping_.adjustment().move(T);
  mapping_.adjustment().begin_at(covariance);
  relocaliser_.move_each(T, [&](const Quat& q_WC, const Vec3& p_W) { return loops.near(q_WC, p_W, *median_depth); });
  move_mark(loops.near(mark_.q_WC, mark_.p_W, *median_depth));
  *median_depth *= T.s;
  const auto place = static_cast<std::uint32_t>(loop.place);
  if (relocaliser_.keeper().bring_back(place)) relocaliser_.keeper().bring_points(place);
  relocaliser_.keeper().bring_near(motion_.view(), *median_depth, tuning::place::kMaxReturns);
  settings_.hooks.say("map ", tracking_.map_id(), " comes back to place ", loop.place, ": moved by ",
                      fixed((T.of(loop.at_W) - loop.at_W).norm(), 3), " and ", degrees(log_so3(T.q).norm()),
                      " deg, scaled by ", fixed(T.s, 3));
}

void MapPlacement::move(const Similarity& T, Scalar* median_depth) {
  move_window(T, &map_, &planes_, &motion_);
  frame_.correction.add(T);
  mapping_.adjustment().move(T);
  mapping_.loops().move(T);
  map_.tables().anchors.move(tracking_.map_id(), tracking_.map_id(), T);
  relocaliser_.move(T);
  unit_.move(T);
  *median_depth *= T.s;
  move_mark(T);
}

void MapPlacement::move_mark(const Similarity& T) {
  mark_.q_WC = (T.q * mark_.q_WC).normalized();
  mark_.p_W = T.of(mark_.p_W);
  mark_.covariance = T.of_pose_covariance(mark_.covariance);
}

}  // namespace pf
