#include "inertial/rate_check.h"

#include <algorithm>
#include <cmath>

#include "base/elapsed.h"
#include "inertial/tuning.h"

namespace pf {

using namespace tuning::rate_alignment;

namespace {

constexpr double kMinSpan = 0.8;  ///< [s] of an alignment
constexpr double kVerdict = 2.5;  ///< [s] after which one that does not fit is a contradiction
constexpr double kLongest = 4;    ///< [s] of agreement that is required at most, since no more is kept
constexpr Scalar kDegrees = Scalar(57.29578);
constexpr Scalar kNear = Scalar(0.25);        ///< share by which a factor of 57.3 may be off
constexpr Scalar kLikeGravity = Scalar(0.3);  ///< the same of a reading that is as large as gravity
constexpr Scalar kClock = Scalar(0.005);      ///< [s] that a clock is off before it is named

Scalar angle_between(const Mat3& a, const Mat3& b) { return log_so3(Quat(Mat3(a.transpose().lazyProduct(b)))).norm(); }

bool is_other_clock(const RateFit& fit, double at_s) {
  return fit.at_end || std::abs(fit.delay - static_cast<Scalar>(at_s)) > std::max(kClock, 3 * fit.sigma_delay);
}

/// value: as find_reason() sets it.
void log_reason(const Hooks& hooks, UnitReason reason, Scalar value) {
  const auto log = [&](const auto&... parts) { hooks.say("samples of the inertial unit are not used: ", parts...); };
  if (reason == UnitReason::kLeftHanded)
    log("its rates fit the camera's by a reflection, and by no rotation");
  else if (reason == UnitReason::kColumnsSwapped)
    log("its mean rate of ", fixed(value, 2), " reads like gravity");
  else if (reason == UnitReason::kRatesDoNotFit)
    log("of the camera's rates ", fixed(100 * value, 0), " % are explained by no delay and no axes");
  else if (reason == UnitReason::kAxes)
    log("its rates fit the camera's by axes that are ", fixed(value, 1), " deg off");
  else if (reason == UnitReason::kClock)
    log("its rates fit the camera's with a delay of ", fixed(1000 * value, 1), " ms");
  else  // kGyroInDegrees, kGyroScale
    log("its rates are ", fixed(value, 2), " times the camera's");
}

}  // namespace

void RateCheck::init() {
  data_ = Data();
  data_.is_open = settings_.unit.sigma_delay > kOpenDelay || finds_axes();
  if (data_.is_open) data_.reason = UnitReason::kWaitsForRotation;
}

bool RateCheck::finds_axes() const { return settings_.unit.sigma_turn > kOpenTurn; }

UnitReason RateCheck::reason(Scalar* value, Mat3* R_CB) const {
  *value = data_.value;
  *R_CB = data_.R_CB;
  return data_.reason;
}

/// The required time [s] grows with each rejection.
double RateCheck::wanted_span(bool is_rejected, int doubts) const {
  if (!is_rejected) return kMinSpan;
  return static_cast<double>(tuning::unit_watch::kWindow) * (1 << std::max(0, doubts - 1));
}

bool RateCheck::is_believed(const RateFit& fit) const {
  const bool clear = fit.next_left > kClearly * fit.left && !fit.at_end && fit.sigma_delay < kMaxSigmaDelay;
  const bool axes = !finds_axes() || fit.sigma_turn < kMaxSigmaTurn;
  return clear && axes && fit.left < kMaxLeft && fit.scale < kMaxScale && fit.scale * kMaxScale > Scalar(1) &&
         fit.turning > kMinTurning;
}

/// In a map in metres a rejected unit stays out.
bool RateCheck::note(const UnitFrame& frame, bool is_rejected, int doubts) {
  const std::int64_t t_ns = frame_.report.t_ns;
  const bool follows = frame.before_was_tracked && frame.is_tracked;
  const Quat q_WC = filter_.state().body.q_WC;
  if (data_.has_fit || filter_.uses_samples() || (is_rejected && filter_.is_metric())) return false;
  const RateBegin begin = data_.begin;
  if (follows && begin.t_ns != 0 && begin.t_ns < t_ns && begin.generation == filter_.generation())
    data_.rates.add(
        begin.t_ns, t_ns,
        log_so3(Quat(begin.q_WC.conjugate() * q_WC)) / static_cast<Scalar>(seconds(elapsed_ns(begin.t_ns, t_ns))));
  data_.begin = {follows ? t_ns : 0, q_WC, filter_.generation()};
  const double span = std::min(wanted_span(is_rejected, doubts), kLongest);
  if (!follows || ++data_.until_fit < kEvery || data_.rates.span() < span) return false;
  data_.until_fit = 0;
  const bool finds_delay = settings_.body.has(BodyPart::kDelay);
  const Mat3& R_CB = filter_.state().mounting.R_CB;
  const double at_s =
      seconds(settings_.unit.delay_ns) + (finds_delay ? static_cast<double>(filter_.state().mounting.delay) : 0);
  data_.has_fit = data_.rates.fit(imu_, at_s, RateAlignment::kReach, finds_axes() ? nullptr : &R_CB, &data_.fit) &&
                  is_believed(data_.fit) && (finds_delay || !is_other_clock(data_.fit, at_s));
  return !data_.has_fit && data_.rates.span() > kVerdict && find_reason(at_s);
}

/// Whether any delay within reach and any axes would fit.
bool RateCheck::find_reason(double at_s) {
  RateFit fit;
  if (!data_.rates.fit(imu_, at_s, RateAlignment::kReach, nullptr, &fit) || !(fit.turning > kMinTurning)) return false;
  const UnitReason before = data_.reason;
  const Scalar times = fit.scale > Scalar(0) ? 1 / fit.scale : Scalar(0);
  const Scalar off = angle_between(fit.R_CB, filter_.state().mounting.R_CB);
  const bool knows_axes = fit.sigma_turn < kMaxSigmaTurn;
  data_.R_CB = fit.R_CB;
  const auto set = [&](UnitReason reason, Scalar value) {
    data_.reason = reason;
    data_.value = value;
  };
  if (fit.mirrored && fit.left_mirrored < kMaxLeft) {
    set(UnitReason::kLeftHanded, 0);
  } else if (!(fit.left < kMaxLeft)) {
    const Scalar gyro = mean_rate();
    const bool swapped = std::abs(gyro - settings_.unit.gravity) < kLikeGravity * settings_.unit.gravity;
    if (swapped || data_.rates.span() > 2 * kVerdict)
      set(swapped ? UnitReason::kColumnsSwapped : UnitReason::kRatesDoNotFit, swapped ? gyro : fit.left);
  } else if (std::abs(times / kDegrees - 1) < kNear) {
    set(UnitReason::kGyroInDegrees, times);
  } else if (times > kMaxScale || times * kMaxScale < Scalar(1)) {
    set(UnitReason::kGyroScale, times);
  } else if (knows_axes && off > kOtherAxes && !finds_axes()) {
    set(UnitReason::kAxes, off * kDegrees);
  } else if (is_other_clock(fit, at_s)) {
    set(UnitReason::kClock, fit.delay);
  }
  if (data_.reason == before || data_.reason <= UnitReason::kContradicts) return false;
  log_reason(settings_.hooks, data_.reason, data_.value);
  return true;
}

/// Mean length of the rates that are held.
Scalar RateCheck::mean_rate() const {
  Scalar sum = 0;
  for (int i = 0; i < imu_.held(); ++i) {
    const Scalar* v = imu_[i].gyro;
    sum += Vec3(v[0], v[1], v[2]).norm();
  }
  return imu_.held() > 0 ? sum / static_cast<Scalar>(imu_.held()) : Scalar(0);
}

}  // namespace pf
