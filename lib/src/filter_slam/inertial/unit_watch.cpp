#include "filter_slam/inertial/unit_watch.h"

#include <algorithm>
#include <cmath>

#include "base/elapsed.h"
#include "filter/inertial_motion.h"
#include "filter_slam/inertial/tuning.h"

namespace pf {

using namespace tuning::unit_watch;

namespace {

constexpr double kFrozen = 1;      ///< [s] of use, or in metres, before noise is learned
constexpr double kRateChange = 4;  ///< sample intervals, of which the angular acceleration is taken

}  // namespace

void UnitWatch::layout(Arena& arena) {
  if (settings_.inertial) data_ = arena.take<Data>(1);
}

void UnitWatch::init() {
  if (data_ != nullptr) {
    *data_ = Data();
    using namespace tuning::rate_alignment;
    data_->open = settings_.unit.sigma_delay > kOpenDelay || settings_.unit.sigma_turn > kOpenTurn;
    if (data_->open) data_->reason = UnitReason::kWaitsForRotation;
  }
  filter_.use_samples(!is_open());
}

/// Samples stop, or have not begun yet.
bool UnitWatch::is_silent(std::int64_t t_ns) const {
  if (imu_.held() == 0) return true;
  const std::int64_t last_ns = imu_.counts().last_ns, now_ns = motion_.on_unit_clock(t_ns);
  return last_ns < now_ns && seconds(elapsed_ns(last_ns, now_ns)) > static_cast<double>(kSilence);
}

void UnitWatch::begin_frame(std::int64_t before_ns, std::int64_t t_ns) {
  if (data_ == nullptr) return;
  motion_.unit_noise().note_samples();
  ImuReading reading;
  if (data_->fresh || (filter_.uses_samples() && (leaves_out() || is_silent(t_ns)))) {
    leave_samples(before_ns);
  } else if (!filter_.uses_samples() && (!leaves_out() || data_->passed) && !is_silent(t_ns)) {
    if (data_->passed) use_alignment();
    data_->prior_ns = before_ns;
    if (reading_at(imu_, motion_.on_unit_clock(before_ns), &reading)) return_to_samples(reading);
  }
  data_->fresh = false;
  data_->follows = data_->contradicted = data_->taken_back = false;
  keep_prior(before_ns);
}

void UnitWatch::keep_prior(std::int64_t before_ns) {
  if (data_ == nullptr) return;
  data_->prior = filter_.state().body;
  data_->prior_ns = before_ns;
}

void UnitWatch::begin_measuring(bool follows) {
  if (data_ == nullptr) return;
  data_->follows = follows && filter_.uses_samples();
  update_.limit_pose_nis(data_->follows ? kMaxPoseNis : Scalar(0));
}

bool UnitWatch::is_refused() {
  if (data_ == nullptr || !data_->follows) return false;
  const FrameReport& report = frame_.report;
  const bool nothing_used = report.inliers == 0;
  data_->contradicted = update_.is_contradicted() || (nothing_used && report.matches >= settings_.min_inliers);
  update_.limit_pose_nis(Scalar(0));
  return data_->contradicted || (nothing_used && report.attempts >= settings_.min_inliers);
}

void UnitWatch::leave_prediction() {
  data_->taken_back = true;
  predict_again(false);
}

void UnitWatch::settle(bool is_tracked) {
  if (is_tracked || data_->contradicted || frame_.report.inliers > 0) return;
  predict_again(true);
  data_->taken_back = false;
}

/// Between the two predictions of this frame: from the one by samples to the other, or back.
void UnitWatch::predict_again(bool by_samples) {
  const std::int64_t t_ns = frame_.report.t_ns;
  Transition transition[2];
  motion_.predict(data_->prior, data_->prior_ns, t_ns, settings_.motion_noise, &transition[by_samples ? 1 : 0]);
  motion_.predict_coasting(data_->prior, data_->prior_ns, t_ns, &transition[by_samples ? 0 : 1]);
  replace_transition(transition[0], &transition[1]);
  filter_.predict(transition[1]);
}

/// Without samples only the two poses say how fast the body rotates, which the next prediction may want again.
void UnitWatch::note_rate() {
  Body body = filter_.state().body;
  const Scalar T = static_cast<Scalar>(seconds(elapsed_ns(data_->prior_ns, frame_.report.t_ns)));
  body.w_C = log_so3(Quat(data_->prior.q_WC.conjugate() * body.q_WC)) / T;
  filter_.set_mean(body);
}

/// Where samples were wrong, the body goes back to where it was tracked last, velocities begin anew, and the pose is off by as much as a
/// body may move meanwhile. Where they only stop, the rate is known as it was.
void UnitWatch::leave_samples(std::int64_t before_ns) {
  const MotionNoise& noise = settings_.motion_noise;
  const Scalar sigma_rate = data_->fresh ? kRate : noise.angular * std::sqrt(kSilence);
  Body body = filter_.state().body;
  if (data_->fresh && data_->tracked_ns < before_ns) {
    body.q_WC = data_->tracked.q_WC;
    body.p_W = data_->tracked.p_W;
    body.v_W = data_->tracked.v_W;
    body.w_C = data_->tracked.w_C;
  }
  Transition transition;
  begin_without_samples(body, settings_.body, filter_.state().mounting, sigma_rate, data_->fresh, kSpeed, &transition);
  if (data_->fresh) {
    const Scalar T = kTime + static_cast<Scalar>(seconds(elapsed_ns(data_->tracked_ns, before_ns)));
    for (int i = 0; i < 3; ++i) {
      transition.Q[(Body::kTheta + i) * (transition.dim + 1)] += noise.angular * noise.angular * T * T * T / 3;
      transition.Q[(Body::kPosition + i) * (transition.dim + 1)] += noise.linear * noise.linear * T * T * T / 3;
    }
  }
  filter_.predict(transition);
  filter_.use_samples(false);
  data_->sum = 0;
}

void UnitWatch::return_to_samples(ImuReading reading) {
  FreshReading fresh;
  fresh.gyro = reading.gyro;
  const double interval = seconds(imu_.counts().median_ns), T = kRateChange * interval;
  ImuReading before;
  Scalar by_delay = 0;  // the reading is of another time by the delay's error
  if (data_->passed && reading_at(imu_, motion_.on_unit_clock(data_->prior_ns) - nanoseconds(T), &before))
    by_delay = data_->fit.sigma_delay * (reading.gyro - before.gyro).norm() / static_cast<Scalar>(T);
  fresh.sigma_gyro =
      std::hypot(motion_.unit_noise().now().gyro_density / std::sqrt(static_cast<Scalar>(interval)), by_delay);
  fresh.anew = data_->doubted;
  fresh.gravity_W = filter_.state().body.gravity_W();
  fresh.sigma_gravity = tuning::inertial::kGravity;
  fresh.sigma_accel_bias = tuning::inertial::kAccelBias;
  Transition transition;
  begin_with_samples(filter_.state().body, settings_.body, filter_.state().mounting, fresh, &transition);
  filter_.predict(transition);
  filter_.use_samples(true);
  if (data_->doubted) settings_.hooks.say("the inertial unit agrees with the pictures again: its samples are used");
  if (data_->open)
    settings_.hooks.say("the inertial unit's clock and axes are found by the camera's rotations: its samples are used");
  data_->doubted = data_->open = data_->passed = false;
  data_->reason = UnitReason::kNone;
  data_->sum = 0;
  data_->used_ns = 0;
}

/// Takes the delay from the rates, where it is estimated, and the axes where they were open.
void UnitWatch::use_alignment() {
  using namespace tuning::rate_alignment;
  const RateFit& fit = data_->fit;
  Mounting mounting = filter_.state().mounting;
  const bool finds_axes = settings_.unit.sigma_turn > kOpenTurn;
  const Mat3 turned = fit.R_CB.transpose().lazyProduct(mounting.R_CB);
  if (finds_axes) mounting.R_CB = fit.R_CB;
  if (settings_.body.has(BodyPart::kDelay))
    mounting.delay = fit.delay - static_cast<Scalar>(seconds(settings_.unit.delay_ns));
  Transition transition;
  begin_mounting(filter_.state().body, settings_.body, finds_axes ? turned : Mat3(Mat3::Identity()),
                 finds_axes ? std::hypot(fit.sigma_turn, kFloorTurn) : Scalar(0),
                 std::hypot(fit.sigma_delay, kFloorDelay), &transition);
  filter_.predict(transition);
  filter_.set_mounting(mounting);
  data_->aligned = true;
}

bool UnitWatch::take_alignment() {
  const bool aligned = data_ != nullptr && data_->aligned;
  if (aligned) data_->aligned = false;
  return aligned;
}

/// What a frame says against the samples, of a chi-square of six. A frame that needs the prediction without them says as much as one can.
/// A frame that neither prediction explains says nothing against the samples.
Scalar UnitWatch::contradiction(bool before_was_tracked, bool is_tracked) const {
  const FrameReport& report = frame_.report;
  if (!is_tracked) return kSlack;
  if (data_->taken_back) return kMaxOfFrame;
  if (!before_was_tracked || report.pose_nis_dof == 0) return kSlack;
  return std::min(static_cast<Scalar>(report.pose_nis * Body::kPoseDim / report.pose_nis_dof), kMaxOfFrame);
}

/// Frozen while samples have only begun to be used, or lengths to be metres: what P does not explain then is the start's.
void UnitWatch::learn_noise(bool before_was_tracked, bool is_tracked, std::int64_t dt_ns) {
  const FrameReport& report = frame_.report;
  UnitNoise& noise = motion_.unit_noise();
  data_->used_ns += dt_ns;
  if (!is_tracked || seconds(data_->used_ns) < kFrozen) return;
  const bool forces = filter_.is_metric() && seconds(data_->metric_ns) > kFrozen;
  if (data_->taken_back) {
    const bool known = data_->contradicted && update_.is_contradicted();
    const Scalar rotation = known ? update_.contradicting_rotation() : kMaxOfFrame;
    noise.note_innovation(UnitNoise::kGyro, rotation, 3);
    if (forces && known)
      noise.note_innovation(UnitNoise::kAccel, update_.contradicting_nis() - update_.contradicting_rotation(), 3);
  } else if (before_was_tracked && report.pose_nis_dof > 0) {
    const int dof = report.pose_nis_dof / 2;
    noise.note_innovation(UnitNoise::kGyro, static_cast<Scalar>(report.rotation_nis), dof);
    if (forces)
      noise.note_innovation(UnitNoise::kAccel, static_cast<Scalar>(report.pose_nis - report.rotation_nis), dof);
  }
}

/// True where the sum is above its bound. Innovations count against the unit once no plausible noise explains them.
bool UnitWatch::add_evidence(bool before_was_tracked, bool is_tracked, std::int64_t dt_ns) {
  const UnitNoise& noise = motion_.unit_noise();
  const bool on_probation = data_->doubts > 0 && seconds(data_->used_ns) < static_cast<double>(kTrial);
  const bool explained = !noise.is_at_bound(UnitNoise::kGyro) && !noise.is_at_bound(UnitNoise::kAccel);
  const Scalar more = contradiction(before_was_tracked, is_tracked) - kSlack;
  data_->sum = std::max(Scalar(0), data_->sum + (explained ? std::min(more, Scalar(0)) : more));
  if (!(data_->sum < (on_probation ? kBoundOnProbation : kBound))) return true;
  if (is_tracked) {
    data_->tracked = filter_.state().body;
    data_->tracked_ns = frame_.report.t_ns;
    if (filter_.is_metric()) data_->metric_ns += dt_ns;
  }
  if (data_->sum <= 0) data_->sound_ns = data_->metric_ns;
  return false;
}

bool UnitWatch::note(bool before_was_tracked, bool is_tracked, std::int64_t dt_ns) {
  if (data_ == nullptr) return false;
  if (data_->doubted) data_->doubted_ns += dt_ns;
  if (!filter_.is_metric()) data_->metric_ns = data_->sound_ns = 0;
  if (leaves_out()) {
    compare_rates(before_was_tracked && is_tracked);
    return false;
  }
  if (!filter_.uses_samples()) return false;
  learn_noise(before_was_tracked, is_tracked, dt_ns);
  if (data_->taken_back && is_tracked) note_rate();
  if (!add_evidence(before_was_tracked, is_tracked, dt_ns)) return false;
  data_->doubted = data_->fresh = true;
  data_->used_ns = 0;
  data_->doubts = std::min(data_->doubts + 1, kMaxDoublings);
  data_->rates.init();
  data_->rate_begin.t_ns = 0;
  data_->reason = UnitReason::kContradicts;
  settings_.hooks.say(
      "the inertial unit contradicts the pictures: it is doubted, and motion goes on without its samples");
  return true;
}

void UnitWatch::begin_without() {
  data_->fresh = false;
  filter_.use_samples(false);
}

void UnitWatch::use_at_rest(bool use) {
  data_->at_rest = use;
  filter_.use_samples(use);
  data_->rates.init();
  data_->rate_begin.t_ns = 0;
}

bool UnitWatch::is_map_on_trial() const {
  return filter_.is_metric() && seconds(data_->sound_ns) < static_cast<double>(kTrial);
}

}  // namespace pf
