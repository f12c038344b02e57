#include "filter_slam/unit_keeper.h"

#include <new>

namespace pf {

void UnitKeeper::layout(Arena& arena) {
  watch_.layout(arena);
  rest_.layout(arena);
  if (!settings_.inertial) return;
  Parts* const place = arena.take<Parts>(1);
  if (place != nullptr)
    parts_ = new (place)
        Parts{{settings_, filter_, rest_, imu_, motion_}, {settings_, filter_, map_, frame_, imu_, motion_}};
}

void UnitKeeper::init() {
  watch_.init();
  begin_map();
}

void UnitKeeper::begin_map() {
  rest_.init();
  metric_.init();
  if (parts_ == nullptr) return;
  parts_->hold.init();
  parts_->moving.init();
}

void UnitKeeper::predict(std::int64_t before_ns, bool follows, bool nothing_measured, Scalar depth) {
  const std::int64_t t_ns = frame_.report.t_ns;
  watch_.begin_frame(before_ns, t_ns);
  if (parts_ == nullptr || !parts_->hold.predict(follows, before_ns, t_ns, depth))
    advance(before_ns, tracking_.coasting_or_lost(), nothing_measured);
}

void UnitKeeper::advance(std::int64_t before_ns, bool coasting_or_lost, bool nothing_measured) {
  const std::int64_t begin_ns = motion_begin_ns(before_ns);
  watch_.keep_prior(begin_ns);
  motion_.advance(begin_ns, frame_.report.t_ns, coasting_or_lost, nothing_measured);
  if (parts_ != nullptr) parts_->hold.note_motion();
}

std::int64_t UnitKeeper::motion_begin_ns(std::int64_t now_ns) const {
  return parts_ != nullptr ? parts_->hold.motion_begin_ns(now_ns) : now_ns;
}

ScaleChange UnitKeeper::look_for_scale(Scalar depth, Scalar correlation_frames) {
  if (!settings_.inertial || !tracking_.has_pose() || !filter_.uses_samples()) return ScaleChange::kNone;
  RestReading rest;
  if (rest_.note(tracking_.is_tracked(frame_.report), &rest) && metric_.use_rest(rest, rest_.begin_ns())) {
    if (map_.features.count() > 0) return ScaleChange::kMetric;
    rest_.begin_pixels_anew();
    return ScaleChange::kNewMap;
  }
  parts_->hold.end_frame(frame_.report.t_ns);
  return look_for_scale_in_motion(depth, correlation_frames);
}

/// A unit that was ever doubted does not tell it.
ScaleChange UnitKeeper::look_for_scale_in_motion(Scalar depth, Scalar correlation_frames) {
  MovingFrame told;
  told.keep = tracking_.is_tracked(frame_.report) && start_.may_become_metric() && watch_.doubted_ns() == 0;
  told.judge = !start_.recorder().progress().recording;
  told.map_id = tracking_.map_id();
  told.depth = depth;
  told.correlation = correlation_frames;
  MovingSolution solution;
  if (!parts_->moving.note(told, &solution)) return ScaleChange::kNone;
  metric_.use_motion(solution);
  return ScaleChange::kRescaled;
}

bool UnitKeeper::discredits_map(bool follows, std::int64_t dt_ns) {
  if (!settings_.inertial || !tracking_.has_pose()) return false;
  if (!watch_.note(follows && !holds(), tracking_.is_tracked(frame_.report), dt_ns)) return false;
  if (!watch_.is_map_on_trial() || start_.knows_scale() || map_.planes.has_known()) return false;
  watch_.begin_without();
  return true;
}

}  // namespace pf
