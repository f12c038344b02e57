#include "inertial/rest_hold.h"

#include <algorithm>
#include <cmath>

#include "base/elapsed.h"
#include "filter/inertial_motion.h"
#include "inertial/tuning.h"

namespace pf {

using namespace tuning::rest;

namespace {

constexpr double kBySamples = 3;                      ///< [s] for which samples alone measure motion well,
constexpr Scalar kRotationBySamples = Scalar(0.002);  ///< [rad] and as long as the rotation is known so well
constexpr Scalar kSpeedBySamples = Scalar(0.02);      ///< [m/s] and the velocity

}  // namespace

bool RestHold::predict(bool follows, std::int64_t before_ns, std::int64_t t_ns, Scalar depth) {
  const bool held = data_.holds, holds = follow_rest(follows, before_ns, t_ns, depth);
  if (held && !holds) leave();
  return holds;
}

bool RestHold::follow_rest(bool follows, std::int64_t before_ns, std::int64_t t_ns, Scalar depth) {
  const bool held = data_.holds;
  const Scalar dt = static_cast<Scalar>(seconds(elapsed_ns(before_ns, t_ns)));
  data_.holds = false;
  if (!settings_.inertial || !follows || !filter_.is_metric() || !filter_.uses_samples() ||
      !rest_.read_frame(dt, &data_.still))
    return false;
  if (!filter_.take_still(data_.still, settings_.unit.gravity, kMaxNis, false)) {
    rest_.end_rest();
    return false;
  }
  data_.holds = true;
  data_.before_ns = before_ns;
  data_.dt = dt;
  data_.m_per_px = depth / settings_.camera.fx;
  if (!held) begin_rest();
  const Scalar moved = rest_.motion_px();
  const Scalar more2 = std::max(Scalar(0), moved * moved - data_.moved_px * data_.moved_px);
  data_.moved_px = std::max(data_.moved_px, moved);
  data_.sigma_rad = std::sqrt(more2) / settings_.camera.fx;
  move(Scalar(1));
  return true;
}

/// In a frame, an acceleration of kHidden sigma of its samples may pass for none.
void RestHold::begin_rest() {
  data_.moved_px = Scalar(0);
  count_frame(&rests_);
  data_.late_count = 0;
  Transition transition;
  begin_speed(filter_.state().body, settings_.body, kHidden * data_.still.sigma_accel * data_.dt, &transition);
  filter_.predict(transition);
}

/// Applies the readings of the oldest late frame, which belonged to the rest.
void RestHold::take_late() {
  filter_.take_still(data_.late[0].still, settings_.unit.gravity, kAnyNis, true);
  std::copy(data_.late + 1, data_.late + data_.late_count, data_.late);
  --data_.late_count;
}

/// For some frames a hand moves by less than the noise of one frame's samples, while the samples of all these frames together show it. So
/// the body is predicted through them again, from the velocity of the rest on.
std::int64_t RestHold::motion_begin_ns(std::int64_t now_ns) const {
  if (!filter_.uses_samples() || imu_.held() == 0) return now_ns;
  for (int i = 0; i < data_.late_count; ++i)
    if (motion_.on_unit_clock(data_.late[i].before_ns) >= imu_[0].t_ns) return data_.late[i].before_ns;
  return now_ns;
}

/// Gravity was read in axes that motion may yet show to be others.
void RestHold::leave() {
  if (!settings_.body.has(BodyPart::kMountRotation)) return;
  Transition transition;
  allow_for_turned_gravity(filter_.state().body, settings_.body, filter_.unit_turn_variance(), &transition);
  filter_.predict(transition);
}

/// And so it may for as long as the picture does not show it: s = a t^2 / 2, v = a t.
void RestHold::end_rest() {
  data_.holds = false;
  rest_.end_rest();
  const Scalar moved_m = kMaxMeanMotionPx * data_.m_per_px;
  Transition transition;
  begin_speed(filter_.state().body, settings_.body, std::sqrt(2 * kHidden * data_.still.sigma_accel * moved_m),
              &transition);
  filter_.predict(transition);
  leave();
}

/// Predicts the frame, or takes that back.
void RestHold::move(Scalar sign) {
  Transition transition;
  predict_at_rest(filter_.state().body, settings_.body, data_.dt, motion_.unit_noise().now(), data_.sigma_rad,
                  data_.sigma_rad * settings_.camera.fx * data_.m_per_px, &transition);
  for (int i = 0; i < transition.dim * transition.dim; ++i) transition.Q[i] *= sign;
  filter_.predict(transition);
}

void RestHold::take_back() {
  move(Scalar(-1));
  end_rest();
}

bool RestHold::has_just_ended(std::int64_t t_ns) {
  if (data_.holds || data_.last_ns == INT64_MIN || !filter_.is_metric() || !filter_.uses_samples()) return false;
  const auto known = [&](int first, Scalar sigma) {
    for (int i = first; i < first + 3; ++i)
      if (!(filter_.variance(i) < sigma * sigma)) return false;
    return true;
  };
  if (seconds(elapsed_ns(data_.last_ns, t_ns)) < kBySamples && known(Body::kTheta, kRotationBySamples) &&
      known(settings_.body.row(BodyPart::kVelocity), kSpeedBySamples))
    return true;
  forget();
  return false;
}

void RestHold::end_frame(std::int64_t t_ns) {
  if (!data_.holds) return;
  data_.last_ns = t_ns;
  if (data_.late_count == kMaxLate) take_late();
  data_.late[data_.late_count++] = {data_.before_ns, data_.still};
  if (!rest_.is_resting()) return end_rest();
  while (data_.late_count > 1 && seconds(elapsed_ns(data_.late[1].before_ns, t_ns)) > kLate) take_late();
}

}  // namespace pf
