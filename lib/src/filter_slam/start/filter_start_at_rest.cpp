#include "base/elapsed.h"
#include "filter_slam/inertial/tuning.h"
#include "filter_slam/start/filter_start.h"

/// FilterStart: what a camera at rest, or one that moves, says of gravity, of the biases of its inertial unit, and so of the
/// scale (lib/docs/inertial.md).

namespace pf {

/// Whether a map of unknown scale may be given up for one in metres: while it is young, or where the camera has not moved since its first
/// frame.
bool FilterStart::may_begin_anew(std::int64_t begin_ns) const {
  const std::int64_t age_ns = elapsed_ns(data_.begin_ns, parts_.frame.report.t_ns);
  return progress().pending() || begin_ns <= data_.begin_ns ||
         seconds(age_ns) < static_cast<double>(tuning::inertial::kYoungMap);
}

bool FilterStart::use_rest(const RestReading& rest, std::int64_t begin_ns) {
  Filter& filter = parts_.filter;
  if (filter.is_metric()) return false;
  if (!data_.knows_scale) {
    if (parts_.map.planes.has_known() || !may_begin_anew(begin_ns)) return false;
    keep_mounting();
    const bool pending = progress().pending();
    end_record();
    if (begin_ns > data_.begin_ns) {
      if (!pending) parts_.tracking.begin_map();
      data_.known = KnownBody();  // it was the pose of the first frame
    }
    parts_.map.features.clear();
    parts_.frame.forget_all();
    clear_filter();
    set_known_pose(false);
  }
  Transition transition;
  const Mounting known = mounting();
  begin_at_rest(filter.state().body, settings_.body, known, rest, &transition);
  filter.predict(transition);
  filter.set_mounting(known);
  if (settings_.body.has(BodyPart::kMountRotation)) {
    allow_for_turned_gravity(filter.state().body, settings_.body, filter.unit_turn_variance(), &transition);
    filter.predict(transition);
  }
  filter.set_metric();
  data_.from_motion = false;
  settings_.hooks.say("at rest: gravity and the biases are known, lengths are in metres from here on");
  return true;
}

bool FilterStart::may_become_metric() const {
  const std::int64_t age_ns = elapsed_ns(data_.begin_ns, parts_.frame.report.t_ns);
  return !parts_.filter.is_metric() && !data_.knows_scale && !parts_.map.planes.has_known() &&
         seconds(age_ns) < static_cast<double>(tuning::inertial::kYoungMap);
}

bool FilterStart::use_motion(const MovingSolution& solution) {
  parts_.filter.set_metric(solution, mounting());
  data_.from_motion = true;
  scale_tables(solution.scale, Vec3::Zero());
  parts_.tracking.rename_map();
  settings_.hooks.say("from motion: gravity and the biases are known, lengths are in metres from here on");
  return true;
}

}  // namespace pf
