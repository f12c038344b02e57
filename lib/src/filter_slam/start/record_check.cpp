#include "filter_slam/start/record_check.h"

#include "filter_slam/features/wall_rays.h"
#include "filter_slam/start/tuning.h"
#include "frame/start/tuning.h"
#include "geometry/common_ratio.h"
#include "map/tuning.h"

namespace pf {

using namespace tuning::start_before_walls;

Scalar unit_by_target(const Map& map, const Target& target, const StartWithoutTarget& record) {
  Scalar distances = 0, of_record = 0;
  for (int i = 0; i < map.features.capacity(); ++i) {
    const Feature& f = map.features[i];
    const int index = map.features.used(i) && f.is_target ? record.index_of(f.id) : -1;
    if (index < 0 || !record.bundle().good(index)) continue;
    distances += (target.point_W[f.external_id] - record.base_p_W()).norm();
    of_record += record.record().ray(index).norm() / record.bundle().rho(index);
  }
  return of_record > Scalar(0) ? distances / of_record : Scalar(0);
}

Scalar unit_by_walls(const Filter& filter, const Map& map, const StartWithoutTarget& record) {
  Scalar ratio[StartRecord::kMaxFeatures];
  int count = 0;
  for (int i = 0; i < record.record().features(); ++i) {
    if (!record.bundle().good(i)) continue;
    const Scalar range = range_in_plan(filter, map, record.base_p_W(), record.base_q_WC() * record.record().ray(i));
    if (range > Scalar(0)) ratio[count++] = range * record.bundle().rho(i);
  }
  const CommonRatio common = find_common_ratio(ratio, count, kOneWall);
  const bool clear = common.votes >= kMinOnWall && common.votes >= kClearMajority * common.others;
  return clear ? common.ratio : Scalar(0);
}

bool depths_agree(const Filter& filter, const Map& map, const StartWithoutTarget& record, Scalar unit) {
  using tuning::filter_start::kSameDepth;
  int compared = 0, agree = 0;
  for (int i = 0; i < map.features.capacity(); ++i) {
    const Feature& f = map.features[i];
    const int index = map.features.used(i) && !f.is_target ? record.index_of(f.id) : -1;
    if (index < 0 || !record.bundle().good(index)) continue;
    const Vec3 ray_W = record.base_q_WC() * record.record().ray(index);
    const Scalar of_filter = ray_W.normalized().dot(filter.point(f.slot) - record.base_p_W());
    const Scalar of_record = unit * ray_W.norm() / record.bundle().rho(index);
    ++compared;
    agree += of_filter * kSameDepth > of_record && of_filter < of_record * kSameDepth ? 1 : 0;
  }
  return tuning::filter_start::kMinSame * agree >= compared;
}

bool motion_agrees(const Filter& filter, const StartWithoutTarget& record, Scalar unit) {
  const StartRecord& frames = record.record();
  const Vec3 of_record = record.base_q_WC() * frames.frame(frames.frames() - 1).p_W * unit;
  const Vec3 of_filter = filter.state().body.p_W - record.base_p_W();
  return (of_filter - of_record).norm() < kSameMotion * of_record.norm();
}

}  // namespace pf
