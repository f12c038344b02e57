#include "filter_slam/unit_keeper.h"

#include <cmath>
#include <new>

#include "filter/frame_pixels.h"
#include "inertial/tuning.h"

namespace pf {

namespace {

constexpr double kPatience = 5;  ///< [s] of a map, after which waiting for a better scale costs more than it brings

}  // namespace

void UnitKeeper::layout(Arena& arena) {
  watch_.layout(arena);
  rest_.layout(arena);
  if (!settings_.inertial) return;
  Parts* const place = arena.take<Parts>(1);
  if (place != nullptr)
    parts_ = new (place) Parts{
        {settings_, filter_, rest_, imu_, motion_}, {settings_, filter_, frame_, imu_, motion_}, {settings_, imu_}};
}

void UnitKeeper::init() {
  watch_.init();
  motion_.unit_noise().init();
  if (parts_ != nullptr) parts_->forces.init();
  begin_map();
}

void UnitKeeper::begin_map() {
  rest_.init();
  metric_.init();
  has_just_aligned_ = false;
  discredit_ = Discredit::kNone;
  if (parts_ == nullptr) return;
  parts_->hold.init();
  parts_->moving.init();
}

void UnitKeeper::predict(std::int64_t before_ns, bool follows, bool nothing_measured, Scalar depth) {
  const std::int64_t t_ns = frame_.report.t_ns;
  watch_.begin_frame(before_ns, t_ns);
  has_just_aligned_ = watch_.take_alignment();
  if (has_just_aligned_) {
    start_.mounting().keep();
    parts_->moving.integrate_again();
  }
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

/// A rest gives the scale whatever the delay is, and gravity where the axes are known.
bool UnitKeeper::begins_at_rest() {
  RestReading rest;
  const bool knows_axes = !(settings_.unit.sigma_turn > tuning::rate_alignment::kOpenTurn);
  const bool was_used = filter_.uses_samples(), open = watch_.mode() == UnitMode::kUnaligned && knows_axes;
  if ((!was_used && !open) || !rest_.note(tracking_.is_tracked(frame_.report), &rest)) return false;
  if (!was_used) watch_.take(UnitEvent::kRest);
  if (reads_force() && metric_.use_rest(rest, rest_.begin_ns())) return true;
  if (!was_used) watch_.take(UnitEvent::kMotion);
  return false;
}

ScaleChange UnitKeeper::look_for_scale(Scalar depth, Scalar correlation_frames) {
  if (!settings_.inertial || !tracking_.has_pose()) return ScaleChange::kNone;
  note_forces();
  if (begins_at_rest()) {
    if (map_.features.count() > 0) return ScaleChange::kMetric;
    rest_.begin_pixels_anew();
    return ScaleChange::kNewMap;
  }
  if (filter_.uses_samples()) parts_->hold.end_frame(frame_.report.t_ns);
  return look_for_scale_in_motion(depth, correlation_frames);
}

/// Frames are kept while the delay is open, and judged once it is not.
ScaleChange UnitKeeper::look_for_scale_in_motion(Scalar depth, Scalar correlation_frames) {
  MovingFrame told;
  told.view = {filter_.state().body.q_WC, filter_.state().body.p_W};
  told.is_placed = true;
  const bool open = watch_.is_open() && !is_rejected(watch_.mode());
  told.keep = tracking_.is_tracked(frame_.report) && start_.may_become_metric() && (filter_.uses_samples() || open) &&
              reads_force();
  told.judge = !start_.recorder().progress().recording && filter_.uses_samples();
  told.patient = start_.map_age() < kPatience;
  told.map_id = tracking_.map_id();
  told.depth = depth;
  told.correlation = correlation_frames;
  MovingSolution solution;
  if (!parts_->moving.note(told, moving_points(), &solution)) return ScaleChange::kNone;
  frame_.correction.add(Similarity::about(Vec3::Zero(), solution.scale));
  frame_.correction.rename(tracking_.map_id());
  metric_.use_motion(solution);
  return ScaleChange::kRescaled;
}

MovingPoints UnitKeeper::moving_points() const {
  const auto find = [](const void* owner, std::uint32_t id, Vec3* p_W) {
    const UnitKeeper& keeper = *static_cast<const UnitKeeper*>(owner);
    const Filter& filter = keeper.filter_;
    const int entry = keeper.map_.features.entry_of(id);
    if (entry < 0) return false;
    const int slot = keeper.map_.features[entry].slot;
    const Block& block = filter.state().block[slot];
    if (block.kind == BlockKind::kInverseDepth) {
      const Scalar rho = block.inverse_depth().rho;
      if (!(rho > Scalar(0) &&
            std::sqrt(filter.block_variance(slot, 2)) < tuning::moving_verdict::kMaxDepthSigma * rho))
        return false;
    }
    *p_W = filter.point(slot);
    return true;
  };
  const auto pixel_of = [](const void* owner, const Match& match) {
    const UnitKeeper& keeper = *static_cast<const UnitKeeper*>(owner);
    return at_frame_time(keeper.filter_, keeper.map_.features[match.feature].slot, match.measured);
  };
  return {this, filter_.lens(), find, pixel_of};
}

void UnitKeeper::note_forces() {
  const bool has_axes = !watch_.is_open() || !(settings_.unit.sigma_turn > tuning::rate_alignment::kOpenTurn);
  parts_->forces.note(filter_.state().body.q_WC.toRotationMatrix() * filter_.state().mounting.R_CB,
                      has_axes && tracking_.is_tracked(frame_.report));
}

bool UnitKeeper::reads_force() const {
  Scalar value;
  return parts_->forces.reason(&value) == UnitReason::kNone;
}

UnitReason UnitKeeper::reason(Scalar* value, Mat3* R_CB) const {
  if (parts_ == nullptr) return UnitReason::kNone;
  return reason_of(watch_, parts_->forces, parts_->moving, {filter_.is_metric(), tracking_.has_pose()}, value, R_CB);
}

void UnitKeeper::let_samples_begin() {
  if (has_just_aligned_ && start_.may_become_metric()) discredit_ = Discredit::kSamplesBegin;
}

/// A map that began at rest, with a unit of unknown delay, has no scale from motion yet, so discarding it loses nothing.
bool UnitKeeper::discredits_map(bool follows, std::int64_t dt_ns) {
  if (!settings_.inertial || !tracking_.has_pose()) return false;
  if (discredit_ == Discredit::kSamplesBegin) return true;
  const bool left_rest = watch_.mode() == UnitMode::kAtRest && !rest_.is_resting();
  if (left_rest) watch_.take(UnitEvent::kMotion);
  const bool doubted = watch_.note(follows && !holds(), tracking_.is_tracked(frame_.report), dt_ns);
  if (!left_rest && !(doubted && watch_.is_map_on_trial())) return false;
  if (start_.knows_scale() || map_.planes.has_known()) {
    if (left_rest) watch_.take(UnitEvent::kGoesOn);
    return false;
  }
  discredit_ = left_rest ? Discredit::kLeftRest : Discredit::kRejected;
  watch_.take(UnitEvent::kNewMap);
  return true;
}

const char* UnitKeeper::why_discredited() const {
  switch (discredit_) {
    case Discredit::kSamplesBegin:
      return "the inertial unit's clock and axes are found, and the new map uses its samples";
    case Discredit::kLeftRest:
      return "the camera leaves its rest before the inertial unit's clock and axes are known";
    case Discredit::kRejected:
      return "its scale came from an inertial unit that is rejected";
    case Discredit::kNone:
      break;
  }
  return "";
}

}  // namespace pf
