#include "inertial/unit_watch.h"

#include <algorithm>
#include <cmath>
#include <new>

#include "base/elapsed.h"
#include "filter/inertial_motion.h"
#include "geometry/small_cholesky.h"
#include "inertial/tuning.h"

namespace pf {

using namespace tuning::unit_watch;

namespace {

constexpr double kRateChange = 4;  ///< sample intervals, of which the angular acceleration is taken

Mat6 pose_covariance(const Filter& filter) {
  Scalar P[6 * 6];
  filter.body_covariance(6, P);
  return Eigen::Map<const Eigen::Matrix<Scalar, 6, 6, Eigen::RowMajor>>(P);
}

}  // namespace

void UnitWatch::layout(Arena& arena) {
  if (!settings_.inertial) return;
  Parts* const place = arena.take<Parts>(1);
  if (place != nullptr)
    parts_ = new (place) Parts{{filter_, frame_, motion_.unit_noise()}, {settings_, filter_, imu_, frame_}, Data()};
}

void UnitWatch::init() {
  if (parts_ == nullptr) return filter_.use_samples(true);
  parts_->evidence.init();
  parts_->rates.init();
  parts_->data = Data();
  set_mode(is_open() ? UnitMode::kUnaligned : next_mode(UnitMode::kSilent, UnitEvent::kUsed, parts_->evidence.use()));
}

void UnitWatch::set_mode(UnitMode mode) {
  parts_->data.mode = mode;
  filter_.use_samples(uses_samples(mode));
}

void UnitWatch::take(UnitEvent event) {
  if (event == UnitEvent::kRest || event == UnitEvent::kMotion) parts_->rates.begin();
  set_mode(next_mode(parts_->data.mode, event, parts_->evidence.use()));
}

/// Samples stop, or have not begun yet.
bool UnitWatch::is_silent(std::int64_t t_ns) const {
  if (imu_.held() == 0) return true;
  const std::int64_t last_ns = imu_.counts().last_ns, now_ns = motion_.on_unit_clock(t_ns);
  return last_ns < now_ns && seconds(elapsed_ns(last_ns, now_ns)) > static_cast<double>(kSilence);
}

void UnitWatch::begin_frame(std::int64_t before_ns, std::int64_t t_ns) {
  if (parts_ == nullptr) return;
  motion_.unit_noise().note_samples();
  ImuReading reading;
  const UnitMode mode = parts_->data.mode;
  const RateFit* const fit = parts_->rates.fit();
  if (uses_samples(mode) && (leaves_out(mode) || is_silent(t_ns))) {
    leave_samples(before_ns);
  } else if (!uses_samples(mode) && (!leaves_out(mode) || fit != nullptr) && !is_silent(t_ns)) {
    if (fit != nullptr) use_alignment(*fit);
    parts_->data.prior_ns = before_ns;
    if (reading_at(imu_, motion_.on_unit_clock(before_ns), &reading)) return_to_samples(reading);
  }
  parts_->data.follows = parts_->data.is_contradicted = parts_->data.is_taken_back = false;
  parts_->data.is_worse_than_none = false;
  keep_prior(before_ns);
}

void UnitWatch::keep_prior(std::int64_t before_ns) {
  if (parts_ == nullptr) return;
  parts_->data.prior = filter_.state().body;
  parts_->data.prior_ns = before_ns;
}

Scalar UnitWatch::begin_measuring(bool follows) {
  if (parts_ == nullptr) return 0;
  parts_->data.follows = follows && filter_.uses_samples();
  return parts_->data.follows ? kMaxPoseNis : Scalar(0);
}

bool UnitWatch::is_refused(bool is_contradicted) {
  if (parts_ == nullptr || !parts_->data.follows) return false;
  const FrameReport& report = frame_.report;
  const bool nothing_used = report.inliers == 0;
  const bool disagree = report.matches >= settings_.min_inliers && report.consensus < settings_.min_inliers;
  parts_->data.is_contradicted = is_contradicted || (nothing_used && disagree);
  return parts_->data.is_contradicted || (nothing_used && report.attempts >= settings_.min_inliers);
}

void UnitWatch::leave_prediction() {
  Data& data = parts_->data;
  data.is_taken_back = true;
  data.by_samples = filter_.state().body;
  predict_again(false);
  data.by_none = filter_.state().body;
  data.P_by_none = pose_covariance(filter_);
}

/// Of the two errors e = pose - prediction, with the covariance of the correction from the prediction without samples:
///
///   e_sᵀ (P⁻ - P⁺)⁻¹ e_s - e_nᵀ (P⁻ - P⁺)⁻¹ e_n > slack
///
/// A unit that is merely noisier than stated still predicts better than none.
bool UnitWatch::is_worse_than_none() const {
  const Data& data = parts_->data;
  const Body& body = filter_.state().body;
  SmallCholesky<6> S;
  if (!S.factor(Mat6(data.P_by_none - pose_covariance(filter_)))) return false;
  const auto nis = [&](const Body& predicted) {
    Vec6 e;
    e << log_so3(body.q_WC * predicted.q_WC.conjugate()), body.p_W - predicted.p_W;
    return e.dot(S.solve<1>(e));
  };
  return nis(data.by_samples) - nis(data.by_none) > kSlack;
}

void UnitWatch::settle(bool is_tracked) {
  if (!parts_->data.is_taken_back) return;
  parts_->data.is_worse_than_none = is_tracked && is_worse_than_none();
  if (is_tracked || parts_->data.is_contradicted || frame_.report.inliers > 0) return;
  predict_again(true);
  parts_->data.is_taken_back = false;
}

/// Between the two predictions of this frame: from the one by samples to the other, or back.
void UnitWatch::predict_again(bool by_samples) {
  const std::int64_t t_ns = frame_.report.t_ns;
  Transition transition[2];
  motion_.predict(parts_->data.prior, parts_->data.prior_ns, t_ns, settings_.motion_noise,
                  &transition[by_samples ? 1 : 0]);
  motion_.predict_coasting(parts_->data.prior, parts_->data.prior_ns, t_ns, &transition[by_samples ? 0 : 1]);
  replace_transition(transition[0], &transition[1]);
  filter_.predict(transition[1]);
}

/// Without samples only the two poses give the body's angular velocity, which the next prediction may need.
void UnitWatch::note_rate() {
  Body body = filter_.state().body;
  const Scalar T = static_cast<Scalar>(seconds(elapsed_ns(parts_->data.prior_ns, frame_.report.t_ns)));
  body.w_C = log_so3(Quat(parts_->data.prior.q_WC.conjugate() * body.q_WC)) / T;
  filter_.set_mean(body);
}

/// Where samples were wrong, the body goes back to where it was tracked last, velocities begin anew, and the pose is off by as much as a
/// body may move meanwhile. Where they only stop, the rate is known as it was.
void UnitWatch::leave_samples(std::int64_t before_ns) {
  const MotionNoise& noise = settings_.motion_noise;
  const bool was_wrong = parts_->data.mode == UnitMode::kContradicted;
  const Scalar sigma_rate = was_wrong ? kRate : noise.angular * std::sqrt(kSilence);
  Body body = filter_.state().body;
  if (was_wrong && parts_->data.tracked_ns < before_ns) {
    body.q_WC = parts_->data.tracked.q_WC;
    body.p_W = parts_->data.tracked.p_W;
    body.v_W = parts_->data.tracked.v_W;
    body.w_C = parts_->data.tracked.w_C;
  }
  Transition transition;
  begin_without_samples(body, settings_.body, filter_.state().mounting, sigma_rate, was_wrong, kSpeed, &transition);
  if (was_wrong) {
    const Scalar T = kTime + static_cast<Scalar>(seconds(elapsed_ns(parts_->data.tracked_ns, before_ns)));
    for (int i = 0; i < 3; ++i) {
      transition.Q[(Body::kTheta + i) * (transition.dim + 1)] += noise.angular * noise.angular * T * T * T / 3;
      transition.Q[(Body::kPosition + i) * (transition.dim + 1)] += noise.linear * noise.linear * T * T * T / 3;
    }
  }
  filter_.predict(transition);
  parts_->evidence.end_use();
  take(UnitEvent::kLeft);
}

void UnitWatch::return_to_samples(ImuReading reading) {
  FreshReading fresh;
  fresh.gyro = reading.gyro;
  const double interval = seconds(imu_.counts().median_ns), T = kRateChange * interval;
  ImuReading before;
  Scalar by_delay = 0;  // the reading is of another time by the delay's error
  const RateFit* const fit = parts_->rates.fit();
  if (fit != nullptr && reading_at(imu_, motion_.on_unit_clock(parts_->data.prior_ns) - nanoseconds(T), &before))
    by_delay = fit->sigma_delay * (reading.gyro - before.gyro).norm() / static_cast<Scalar>(T);
  fresh.sigma_gyro =
      std::hypot(motion_.unit_noise().now().gyro_density / std::sqrt(static_cast<Scalar>(interval)), by_delay);
  fresh.anew = is_rejected(parts_->data.mode);
  fresh.gravity_W = filter_.state().body.gravity_W();
  fresh.sigma_gravity = tuning::inertial::kGravity;
  fresh.sigma_accel_bias = tuning::inertial::kAccelBias;
  Transition transition;
  begin_with_samples(filter_.state().body, settings_.body, filter_.state().mounting, fresh, &transition);
  filter_.predict(transition);
  if (fresh.anew)
    settings_.hooks.say("the inertial unit agrees with the camera's motion again, after ",
                        fixed(seconds(parts_->data.rejected_ns), 1), " s of rejection in all: its samples are used");
  if (is_open() && fit != nullptr)
    settings_.hooks.say("the inertial unit's clock and axes are found from ", fit->count,
                        " rotations of the camera: delay ", fixed(1000 * fit->delay, 1), " ms (sigma ",
                        fixed(1000 * fit->sigma_delay, 1), "), axes within ", degrees(fit->sigma_turn),
                        " deg; its samples are used");
  parts_->rates.use();
  parts_->evidence.begin_use();
  take(UnitEvent::kUsed);
}

/// Takes the delay from the rates, where it is estimated, and the axes where they were open.
void UnitWatch::use_alignment(const RateFit& fit) {
  using namespace tuning::rate_alignment;
  Mounting mounting = filter_.state().mounting;
  const bool finds_axes = parts_->rates.finds_axes();
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
  parts_->data.is_aligned = true;
}

bool UnitWatch::take_alignment() {
  const bool is_aligned = parts_ != nullptr && parts_->data.is_aligned;
  if (is_aligned) parts_->data.is_aligned = false;
  return is_aligned;
}

bool UnitWatch::note(bool before_was_tracked, bool is_tracked, std::int64_t dt_ns) {
  if (parts_ == nullptr) return false;
  const UnitFrame frame = {before_was_tracked, is_tracked, parts_->data.is_taken_back, parts_->data.is_worse_than_none,
                           dt_ns};
  UnitEvidence& evidence = parts_->evidence;
  if (is_rejected(parts_->data.mode)) parts_->data.rejected_ns += dt_ns;
  evidence.note_frame();
  if (leaves_out(parts_->data.mode)) {
    if (parts_->rates.note(frame, is_rejected(parts_->data.mode), evidence.doubts())) take(UnitEvent::kMisfit);
    return false;
  }
  if (!uses_samples(parts_->data.mode)) return false;
  evidence.learn_noise(frame);
  take(UnitEvent::kFrame);
  if (frame.is_taken_back && is_tracked) note_rate();
  if (evidence.add(frame, parts_->data.mode)) {
    settings_.hooks.say(
        "the inertial unit contradicts the camera's motion and is rejected: the sum of its innovations is ",
        fixed(evidence.sum(), 1), ", that of this frame ", fixed(frame_.report.pose.nis, 1), " with ",
        frame_.report.pose.dof, " degrees of freedom; motion goes on without samples");
    evidence.count_doubt();
    parts_->rates.contradict();
    take(UnitEvent::kContradiction);
    return true;
  }
  if (is_tracked) {
    parts_->data.tracked = filter_.state().body;
    parts_->data.tracked_ns = frame_.report.t_ns;
  }
  return false;
}

}  // namespace pf
