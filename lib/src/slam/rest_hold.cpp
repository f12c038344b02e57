#include "slam/rest_hold.h"

#include <algorithm>
#include <cmath>

#include "base/elapsed.h"
#include "filter/inertial_motion.h"
#include "slam/tuning.h"

namespace pf {

using namespace tuning::rest;

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
  Transition transition;
  begin_speed(filter_.state().body, settings_.body, kHidden * data_.still.sigma_accel * data_.dt, &transition);
  filter_.predict(transition);
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
  predict_at_rest(filter_.state().body, settings_.body, data_.dt, settings_.unit.noise, data_.sigma_rad,
                  data_.sigma_rad * settings_.camera.fx * data_.m_per_px, &transition);
  for (int i = 0; i < transition.dim * transition.dim; ++i) transition.Q[i] *= sign;
  filter_.predict(transition);
}

void RestHold::take_back() {
  move(Scalar(-1));
  end_rest();
}

void RestHold::end_frame() {
  if (!data_.holds) return;
  if (rest_.is_resting())
    filter_.take_still(data_.still, settings_.unit.gravity, kAnyNis, true);
  else
    end_rest();
}

}  // namespace pf
