#include "filter_slam/start/metric_start.h"

#include "filter_slam/start/walls_apart.h"

namespace pf {

bool MetricStart::use_rest(const RestReading& rest, std::int64_t begin_ns) {
  if (filter_.is_metric()) return false;
  if (!start_.knows_scale() && !start_.begin_anew_at_rest(begin_ns)) return false;
  Transition transition;
  const Mounting known = start_.mounting().now();
  begin_at_rest(filter_.state().body, settings_.body, known, rest, &transition);
  filter_.predict(transition);
  filter_.set_mounting(known);
  if (settings_.body.has(BodyPart::kMountRotation)) {
    allow_for_turned_gravity(filter_.state().body, settings_.body, filter_.unit_turn_variance(), &transition);
    filter_.predict(transition);
  }
  filter_.set_metric();
  is_from_motion_ = false;
  settings_.hooks.say("map ", tracking_.map_id(), " is in metres, from a rest: gravity of ", fixed(rest.gravity, 2),
                      " m/s^2 by a mean specific force of ", fixed(rest.accel.norm(), 2), ", gyroscope bias ",
                      degrees(filter_.state().body.gyro_bias.norm(), 2), " deg/s");
  return true;
}

void MetricStart::use_motion(const MovingSolution& solution) {
  filter_.set_metric(solution, start_.mounting().now());
  is_from_motion_ = true;
  scale_tables(solution.scale, Vec3::Zero(), &map_);
  const std::uint32_t before = tracking_.map_id();
  tracking_.rename_map();
  map_.anchors.move(before, tracking_.map_id(), Similarity::about(Vec3::Zero(), solution.scale));
  settings_.hooks.say("map ", before, " is in metres, from ", fixed(solution.span, 1), " s of motion: scaled by ",
                      fixed(solution.scale, 3), " (sigma ", fixed(100 * solution.sigma_scale(), 1),
                      " %), gravity within ", degrees(solution.sigma_gravity()), " deg; it goes on as map ",
                      tracking_.map_id());
}

}  // namespace pf
