#include "filter_slam/inertial/unit_watch.h"

#include <algorithm>
#include <cmath>

#include "base/elapsed.h"
#include "filter/inertial_motion.h"
#include "filter_slam/inertial/tuning.h"

namespace pf {

using namespace tuning::unit_watch;

void UnitWatch::layout(Arena& arena) {
  if (settings_.inertial) data_ = arena.take<Data>(1);
}

void UnitWatch::init() {
  if (data_ != nullptr) *data_ = Data();
  filter_.use_samples(true);
}

/// Samples stop, or have not begun yet.
bool UnitWatch::is_silent(std::int64_t t_ns) const {
  if (imu_.held() == 0) return true;
  const std::int64_t last_ns = imu_.counts().last_ns, now_ns = motion_.on_unit_clock(t_ns);
  return last_ns < now_ns && seconds(elapsed_ns(last_ns, now_ns)) > static_cast<double>(kSilence);
}

void UnitWatch::begin_frame(std::int64_t before_ns, std::int64_t t_ns) {
  if (data_ == nullptr) return;
  ImuReading reading;
  if (data_->fresh || (filter_.uses_samples() && (data_->doubted || is_silent(t_ns)))) {
    leave_samples(before_ns);
  } else if (!filter_.uses_samples() && (!data_->doubted || data_->passed) && !is_silent(t_ns) &&
             reading_at(imu_, motion_.on_unit_clock(before_ns), &reading)) {
    return_to_samples(reading);
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
  begin_without_samples(body, settings_.body, sigma_rate, data_->fresh, kSpeed, &transition);
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

void UnitWatch::return_to_samples(const ImuReading& reading) {
  FreshReading fresh;
  fresh.gyro = reading.gyro;
  fresh.sigma_gyro =
      settings_.unit.noise.gyro_density / std::sqrt(static_cast<Scalar>(seconds(imu_.counts().median_ns)));
  fresh.anew = data_->doubted;
  fresh.gravity_W = filter_.state().body.gravity_W();
  fresh.sigma_gravity = tuning::inertial::kGravity;
  fresh.sigma_accel_bias = tuning::inertial::kAccelBias;
  Transition transition;
  begin_with_samples(filter_.state().body, settings_.body, filter_.state().mounting, fresh, &transition);
  filter_.predict(transition);
  filter_.use_samples(true);
  if (data_->doubted) settings_.hooks.say("the inertial unit agrees with the pictures again: its samples are used");
  data_->doubted = data_->passed = false;
  data_->sum = 0;
}

/// What a frame says against the samples, of a chi-square of six. Where enough is found and the gate refuses most of it, that is as much as
/// one frame can say.
Scalar UnitWatch::contradiction(bool before_was_tracked, bool is_tracked) const {
  const FrameReport& report = frame_.report;
  if (data_->taken_back) return kMaxOfFrame;
  if (!is_tracked && report.matches >= settings_.min_inliers && kFewPassing * report.inliers < report.matches)
    return kMaxOfFrame;
  if (!before_was_tracked || !is_tracked || report.pose_nis_dof == 0) return kSlack;
  return std::min(static_cast<Scalar>(report.pose_nis * Body::kPoseDim / report.pose_nis_dof), kMaxOfFrame);
}

bool UnitWatch::note(bool before_was_tracked, bool is_tracked, std::int64_t dt_ns) {
  if (data_ == nullptr) return false;
  if (data_->doubted) {
    data_->doubted_ns += dt_ns;
    try_again(before_was_tracked && is_tracked);
    return false;
  }
  if (!filter_.is_metric()) data_->metric_ns = data_->sound_ns = 0;
  if (!filter_.uses_samples()) return false;
  data_->used_ns += dt_ns;
  if (data_->taken_back && is_tracked) note_rate();
  const bool on_probation = data_->doubts > 0 && seconds(data_->used_ns) < static_cast<double>(kTrial);
  data_->sum = std::max(Scalar(0), data_->sum + contradiction(before_was_tracked, is_tracked) - kSlack);
  if (data_->sum < (on_probation ? kBoundOnProbation : kBound)) {
    if (is_tracked) {
      data_->tracked = filter_.state().body;
      data_->tracked_ns = frame_.report.t_ns;
      if (filter_.is_metric()) data_->metric_ns += dt_ns;
    }
    if (data_->sum <= 0) data_->sound_ns = data_->metric_ns;
    return false;
  }
  data_->doubted = data_->fresh = true;
  data_->used_ns = 0;
  data_->doubts = std::min(data_->doubts + 1, kMaxDoublings);
  data_->trial = Trial();
  settings_.hooks.say(
      "the inertial unit contradicts the pictures: it is doubted, and motion goes on without its samples");
  return true;
}

void UnitWatch::begin_without() {
  data_->fresh = false;
  filter_.use_samples(false);
}

bool UnitWatch::is_map_on_trial() const {
  return filter_.is_metric() && seconds(data_->sound_ns) < static_cast<double>(kTrial);
}

/// Takes in one more frame of a doubted unit in a map up to scale, where only its gyro is used: gyro less rate must scatter no more than
/// the rate is known to, and far less than the rate itself.
void UnitWatch::try_again(bool follows) {
  Trial& trial = data_->trial;
  const std::int64_t t_ns = frame_.report.t_ns;
  ImuReading reading;
  if (data_->passed || filter_.is_metric()) return;
  if (!follows || filter_.uses_samples() || !reading_at(imu_, motion_.on_unit_clock(t_ns), &reading) ||
      imu_.counts().saturated != trial.saturated || trial.count == 0) {
    trial = Trial();
    trial.begin_ns = t_ns;
    trial.saturated = imu_.counts().saturated;
    trial.count = follows ? 1 : 0;
    return;
  }
  const Body& body = filter_.state().body;
  const Mat3& R_CB = filter_.state().mounting.R_CB;
  const Vec3 rate = R_CB.transpose() * body.w_C, off = reading.gyro - rate;
  const Scalar n = static_cast<Scalar>(trial.count++);
  const auto add = [&](const Vec3& value, Vec3* mean, Scalar* square) {
    const Vec3 before = value - *mean;
    *mean += before / n;
    *square += before.dot(value - *mean);
  };
  add(off, &trial.off, &trial.off2);
  add(rate, &trial.rate, &trial.rate2);
  const Scalar noise = settings_.unit.noise.gyro_density;
  trial.variance += 3 * noise * noise / static_cast<Scalar>(seconds(imu_.counts().median_ns));
  for (int i = 0; i < 3; ++i) trial.variance += filter_.variance(settings_.body.row(BodyPart::kGyroBias) + i);
  const Scalar wanted = kWindow * static_cast<Scalar>(1 << (data_->doubts - 1));
  const Scalar T = static_cast<Scalar>(seconds(elapsed_ns(trial.begin_ns, t_ns)));
  if (T < wanted || trial.count < kMinFrames ||
      trial.rate2 * static_cast<Scalar>(trial.count) < kMinPower * trial.variance)
    return;
  data_->passed = trial.off2 <= kMaxScatter * trial.variance && trial.off2 <= kMaxShare * trial.rate2;
  trial = Trial();
}

}  // namespace pf
