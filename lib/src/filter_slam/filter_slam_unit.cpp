#include <new>

#include "base/elapsed.h"
#include "filter_slam/filter_slam.h"

/// FilterSlam: what a frame says of the inertial unit (lib/docs/inertial.md).

namespace pf {

/// True where this frame is the first one whose samples tell the scale.
bool FilterSlam::look_for_rest() {
  if (!settings_.inertial || !tracking_.has_pose() || !filter_.uses_samples()) return false;
  StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kImu]);
  RestReading rest;
  if (rest_.note(tracking_.is_tracked(frame_.report), &rest) && start_.use_rest(rest, rest_.begin_ns())) {
    if (map_.features.count() > 0) return true;
    relocaliser_.init();
    rest_.begin_pixels_anew();
    return true;
  }
  unit_->hold.end_frame(frame_.report.t_ns);
  return look_for_scale();
}

/// The same from a camera that moves, and a unit that was never doubted.
bool FilterSlam::look_for_scale() {
  MovingFrame told;
  told.keep = tracking_.is_tracked(frame_.report) && start_.may_become_metric() && watch_.doubted_ns() == 0;
  told.judge = !start_.progress().recording;
  told.map_id = tracking_.map_id();
  told.depth = data_.median_depth;
  told.correlation = data_.image_usable ? noise_.correlation_frames() : Scalar(1);
  MovingSolution solution;
  if (!unit_->moving.note(told, &solution)) return false;
  start_.use_motion(solution);
  relocaliser_.init();
  return true;
}

std::int64_t FilterSlam::motion_begin_ns(std::int64_t now_ns) const {
  return unit_ != nullptr ? unit_->hold.motion_begin_ns(now_ns) : now_ns;
}

/// Predicts the body to this frame.
void FilterSlam::advance(std::int64_t before_ns, bool coasting_or_lost, bool nothing_measured) {
  const std::int64_t begin_ns = motion_begin_ns(before_ns);
  watch_.keep_prior(begin_ns);
  motion_.advance(begin_ns, frame_.report.t_ns, coasting_or_lost, nothing_measured);
  if (unit_ != nullptr) unit_->hold.note_motion();
}

void FilterSlam::layout_unit(Arena& arena) {
  if (!settings_.inertial) return;
  UnitParts* const place = arena.take<UnitParts>(1);
  if (place != nullptr)
    unit_ = new (place)
        UnitParts{{settings_, filter_, rest_, imu_, motion_}, {settings_, filter_, map_, frame_, imu_, motion_}};
}

void FilterSlam::init_unit() {
  if (unit_ == nullptr) return;
  unit_->hold.init();
  unit_->moving.init();
}

/// A map in metres that hangs on a unit in doubt is given up, for nothing tells how wrong it is.
void FilterSlam::watch_unit() {
  if (!settings_.inertial || !tracking_.has_pose()) return;
  if (!watch_.note(data_.follows && !holds(), tracking_.is_tracked(frame_.report), data_.since_last_ns)) return;
  data_.map_discredited = watch_.is_map_on_trial() && !start_.knows_scale() && !map_.planes.has_known();
  if (data_.map_discredited) watch_.begin_without();
}

Status FilterSlam::set_plane_vertical(std::uint32_t id, Scalar sigma) {
  if (!settings_.inertial || !tracking_.has_pose() || !filter_.is_metric()) return Status::kState;
  for (int i = 0; i < map_.planes.capacity(); ++i)
    if (map_.planes.used(i) && map_.planes[i].id == id) return planes_.verticals().tell(i, sigma);
  return Status::kNothing;
}

}  // namespace pf
