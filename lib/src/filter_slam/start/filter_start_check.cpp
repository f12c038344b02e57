#include "filter_slam/features/wall_rays.h"
#include "filter_slam/start/filter_start.h"
#include "filter_slam/start/tuning.h"
#include "frame/start/tuning.h"
#include "geometry/common_ratio.h"

/// FilterStart: what a record is made for, and whether the filter's first depths are those of the record that goes on beside it
/// (lib/docs/starting.md).

namespace pf {

using namespace tuning::filter_start;
using namespace tuning::start_before_walls;

/// Depths come from a record of the first frames, unless walls or a known speed of the first pose tell them.
bool FilterStart::needs_record() const {
  if (!data_.known.given) return true;
  if (parts_.map.planes.has_known() && !has_walls_apart()) return false;
  if (!settings_.body.has(BodyPart::kVelocity)) return true;
  const int dim = settings_.body.known_rows(), first = settings_.body.row(BodyPart::kVelocity);
  Scalar variance = 0;
  for (int i = first; i < first + 3; ++i) variance += data_.known.covariance[i * dim + i];
  return data_.known.body.v_W.squaredNorm() < kKnownSpeed * kKnownSpeed * variance;
}

/// After a start at a target, or at a known pose before walls: where the record tells other depths than the filter has found, the filter
/// has settled in a wrong explanation of the first frames, and begins again with those of the record. Returns whether it did.
bool FilterStart::check_depths(bool settled) {
  const bool by_walls = parts_.map.planes.has_known();  // with a target there is no check beside them
  const Scalar unit = by_walls ? unit_by_walls() : unit_of_record();
  if (!(unit > Scalar(0))) {
    if (by_walls && settled) without_.init();
    return false;
  }
  const bool agree = most_depths_agree(unit) && (!by_walls || motion_agrees(unit));
  if (!agree) {
    restart_from_record(unit);
    settings_.hooks.say(
        by_walls ? "the first depths were wrong: the map begins again at the first pose, with those of all frames since"
                 : "the first depths were wrong: the map begins again at the target, with those of all frames since");
  }
  if (agree || settled) without_.init();
  // Its points lie on walls of the plan. Until now the filter could not tell them from what stands before them.
  if (agree && by_walls) parts_.map.planes.forget_refusals();
  return !agree;
}

/// W's lengths per length of the record: the ratio of the sums of distances of the target's points. Zero where the bundle has none of them.
Scalar FilterStart::unit_of_record() const {
  Scalar distances = 0, of_record = 0;
  for (int i = 0; i < parts_.map.features.capacity(); ++i) {
    const Feature& f = parts_.map.features[i];
    const int index = parts_.map.features.used(i) && f.is_target ? without_.index_of(f.id) : -1;
    if (index < 0 || !without_.bundle().good(index)) continue;
    distances += (target_.target().point_W[f.external_id] - without_.base_p_W()).norm();
    of_record += without_.record().ray(index).norm() / without_.bundle().rho(index);
  }
  return of_record > Scalar(0) ? distances / of_record : Scalar(0);
}

/// W's lengths per length of the record, so that most of its points that are seen before walls of the plan lie on them: the ratio of the
/// two distances that most of these points have in common. Others lie before the wall, or the wall is not there. Zero where no ratio has a
/// clear majority.
Scalar FilterStart::unit_by_walls() const {
  Scalar ratio[StartRecord::kMaxFeatures];
  int count = 0;
  for (int i = 0; i < without_.record().features(); ++i) {
    if (!without_.bundle().good(i)) continue;
    const Scalar range =
        range_in_plan(parts_.filter, parts_.map, without_.base_p_W(), without_.base_q_WC() * without_.record().ray(i));
    if (range > Scalar(0)) ratio[count++] = range * without_.bundle().rho(i);
  }
  const CommonRatio common = find_common_ratio(ratio, count, kOneWall);
  const bool clear = common.votes >= kMinOnWall && common.votes >= kClearMajority * common.others;
  return clear ? common.ratio : Scalar(0);
}

/// Whether for most features the filter and the record tell about the same distance from the first frame.
bool FilterStart::most_depths_agree(Scalar unit) const {
  int compared = 0, agree = 0;
  for (int i = 0; i < parts_.map.features.capacity(); ++i) {
    const Feature& f = parts_.map.features[i];
    const int index = parts_.map.features.used(i) && !f.is_target ? without_.index_of(f.id) : -1;
    if (index < 0 || !without_.bundle().good(index)) continue;
    const Vec3 ray_W = without_.base_q_WC() * without_.record().ray(index);
    const Scalar of_filter = ray_W.normalized().dot(parts_.filter.point(f.slot) - without_.base_p_W());
    const Scalar of_record = unit * ray_W.norm() / without_.bundle().rho(index);
    ++compared;
    agree += of_filter * kSameDepth > of_record && of_filter < of_record * kSameDepth ? 1 : 0;
  }
  return 2 * agree >= compared;
}

/// Whether the filter has moved from the record's first frame to here as the record has: a scene turned inside out is seen from a camera
/// that moves the other way, while many depths are hardly different.
bool FilterStart::motion_agrees(Scalar unit) const {
  const StartRecord& record = without_.record();
  const Vec3 of_record = without_.base_q_WC() * record.frame(record.frames() - 1).p_W * unit;
  const Vec3 of_filter = parts_.filter.state().body.p_W - without_.base_p_W();
  return (of_filter - of_record).norm() < kSameMotion * of_record.norm();
}

/// Empties the filter. Walls of the plan are in it then as they were given.
void FilterStart::clear_all_but_walls() {
  PlaneTable& planes = parts_.map.planes;
  const State& state = parts_.filter.state();
  int frame[kMaxPlanes];
  for (int k = 0; k < planes.capacity(); ++k)
    frame[k] = planes.used(k) && planes[k].known ? state.block[planes[k].slot].frame : -1;
  empty_filter();
  planes.keep_known();
  // The filter keeps the frames of its planes where they are until others take their place, and the first free place is taken first.
  for (int f = 0; f < state.max_planes; ++f)
    for (int k = 0; k < planes.capacity(); ++k) {
      if (frame[k] != f) continue;
      const PlaneFrame plan = state.plane_frame[f];
      planes[k].slot =
          parts_.filter.add_known_plane(plan, planes[k].prior_covariance(), planes[k].roughness, planes[k].apart);
      parts_.filter.set_owner(planes[k].slot, k);
    }
}

}  // namespace pf
