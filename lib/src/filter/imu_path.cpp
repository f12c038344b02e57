#include "filter/imu_path.h"

#include <algorithm>

#include "base/elapsed.h"
#include "filter/tuning.h"

namespace pf {
namespace {

using namespace tuning::imu;

ImuReading reading_of(const ImuSample& s) {
  return {Vec3(s.gyro[0], s.gyro[1], s.gyro[2]), Vec3(s.accel[0], s.accel[1], s.accel[2])};
}

Scalar seconds_between(std::int64_t from_ns, std::int64_t to_ns) {
  return static_cast<Scalar>(seconds(elapsed_ns(from_ns, to_ns)));
}

/// On the line through two samples, at a share of the way from the first to the second.
ImuReading between(const ImuSample& a, const ImuSample& b, Scalar share) {
  const ImuReading from = reading_of(a), to = reading_of(b);
  return {from.gyro + share * (to.gyro - from.gyro), from.accel + share * (to.accel - from.accel)};
}

/// Walks through the samples of a log.
class Walk {
 public:
  Walk(const ImuLog& log, const Coasting& coasting, Preintegral* sum, std::int64_t from_ns)
      : log_(log), coasting_(coasting), sum_(sum), t_ns_(from_ns) {
    while (next_ < log.held() && log[next_].t_ns <= from_ns) ++next_;
    hold_ns_ = static_cast<std::int64_t>(kMaxHold * static_cast<Scalar>(log.counts().median_ns));
    now_.gyro = sum->intrinsics().D_w.inverse() * coasting.w_B + sum->gyro_bias();
  }

  void go_to(std::int64_t to_ns) {
    while (t_ns_ < to_ns) {
      if (next_ < log_.held() && next_ > 0) {
        go_between(to_ns);
      } else if (next_ < log_.held()) {
        coast_to(std::min(to_ns, log_[0].t_ns));
        if (t_ns_ == log_[0].t_ns) take(0);
      } else {
        const std::int64_t last_ns = next_ > 0 ? log_[next_ - 1].t_ns : t_ns_;
        if (next_ > 0 && elapsed_ns(last_ns, t_ns_) < hold_ns_)
          go_beyond(elapsed_ns(last_ns, to_ns) < hold_ns_ ? to_ns : last_ns + hold_ns_);
        else
          coast_to(to_ns);
      }
    }
  }
  const ImuReading& first() const { return first_; }
  const ImuReading& now() const { return now_; }
  Scalar coasted() const { return coasted_; }

 private:
  void take(int sample) {
    now_ = reading_of(log_[sample]);
    next_ = sample + 1;
  }

  /// To the next sample, or to the end before it. What lies in a gap is a bridge between its ends: white accelerations over it. None
  /// reaches over a gap that is too long to coast through, as where the clock has jumped.
  void go_between(std::int64_t to_ns) {
    const ImuSample &a = log_[next_ - 1], &b = log_[next_];
    const Scalar interval = seconds_between(a.t_ns, b.t_ns);
    const auto at = [&](std::int64_t t_ns) { return between(a, b, seconds_between(a.t_ns, t_ns) / interval); };
    const std::int64_t end_ns = std::min(to_ns, b.t_ns);
    if (interval > kMaxCoast) {
      coast_to(end_ns);
      if (end_ns == b.t_ns) take(next_);
      return;
    }
    Scalar gyro_more = 0, accel_more = 0;
    if (interval > kMaxGap * static_cast<Scalar>(seconds(log_.counts().median_ns))) {
      const Scalar b2 = coasting_.noise.angular * coasting_.noise.angular;
      gyro_more = b2 * interval * interval / kBridge;
      accel_more = coasting_.noise.linear * coasting_.noise.linear;
    }
    step(at(t_ns_), end_ns == b.t_ns ? reading_of(b) : at(end_ns), end_ns, gyro_more, accel_more);
    if (end_ns == b.t_ns) ++next_;
  }

  /// Behind the last sample, along the last two.
  void go_beyond(std::int64_t to_ns) {
    const ImuSample& b = log_[next_ - 1];
    ImuReading from = reading_of(b), to = from;
    if (next_ > 1) {
      const ImuSample& a = log_[next_ - 2];
      const Scalar interval = seconds_between(a.t_ns, b.t_ns);
      if (interval <= kMaxGap * static_cast<Scalar>(seconds(log_.counts().median_ns))) {
        from = between(a, b, seconds_between(a.t_ns, t_ns_) / interval);
        to = between(a, b, seconds_between(a.t_ns, to_ns) / interval);
      }
    }
    step(from, to, to_ns, Scalar(0), Scalar(0));
  }

  void step(const ImuReading& from, const ImuReading& to, std::int64_t to_ns, Scalar gyro_more, Scalar accel_more) {
    note_first(from);
    sum_->add(seconds_between(t_ns_, to_ns), from, to, gyro_more, accel_more);
    t_ns_ = to_ns;
    now_ = to;
  }

  void note_first(const ImuReading& reading) {
    if (sum_->dt() <= Scalar(0)) first_ = reading;
  }

  /// What the accelerometer would read of the force that is assumed.
  void read_force() {
    now_.accel = sum_->intrinsics().D_a.inverse() * (sum_->R().transpose() * coasting_.f_B) + sum_->accel_bias();
  }

  void coast_to(std::int64_t to_ns) {
    const Scalar left = std::max(kMaxCoast - coasted_, Scalar(0));  // after it no motion is predictable
    const Scalar dt = std::min(seconds_between(t_ns_, to_ns), left);
    read_force();
    note_first(now_);
    sum_->coast(dt, sum_->rate(now_.gyro), coasting_.f_B, coasting_.noise.angular, coasting_.noise.linear);
    read_force();
    coasted_ += dt;
    t_ns_ = to_ns;
  }

  const ImuLog& log_;
  const Coasting& coasting_;
  Preintegral* sum_;
  std::int64_t t_ns_, hold_ns_ = 0;
  int next_ = 0;  ///< the first sample behind t_ns_
  ImuReading first_, now_;
  Scalar coasted_ = 0;
};

}  // namespace

Scalar integrate_samples(const ImuLog& log, std::int64_t from_ns, std::int64_t to_ns, const Coasting& coasting,
                         Preintegral* sum, ImuReading* at_end) {
  Walk walk(log, coasting, sum, from_ns);
  walk.go_to(to_ns);
  *at_end = walk.now();
  sum->set_ends(walk.first(), walk.now());
  return walk.coasted();
}

bool reading_at(const ImuLog& log, std::int64_t t_ns, ImuReading* reading) {
  int next = log.held() - 1;
  while (next > 0 && log[next - 1].t_ns >= t_ns) --next;
  if (next < 1) return false;
  const ImuSample &a = log[next - 1], &b = log[next];
  const Scalar interval = seconds_between(a.t_ns, b.t_ns);
  const Scalar median = static_cast<Scalar>(seconds(log.counts().median_ns));
  if (t_ns < a.t_ns || interval > kMaxGap * median) return false;
  if (t_ns > b.t_ns && seconds_between(b.t_ns, t_ns) > kMaxHold * median) return false;
  *reading = between(a, b, seconds_between(a.t_ns, t_ns) / interval);
  return true;
}

}  // namespace pf
