#include "inertial/rate_alignment.h"

#include <algorithm>
#include <cmath>

#include "base/elapsed.h"
#include "geometry/symmetric_eigen.h"
#include "inertial/tuning.h"

namespace pf {

using namespace tuning::rate_alignment;

namespace {

constexpr double kCoarse = 0.01;           ///< [s] step of the delay
constexpr double kFine = 0.00125;          ///< [s] the last one, halved from there
constexpr double kApart = 0.05;            ///< [s] what is nearer to the best delay is part of the same minimum
constexpr Scalar kTiny = Scalar(1e-12);    ///< of the largest singular value
constexpr Scalar kNotAlong = Scalar(0.6);  ///< component below which an axis is not along another

/// The rotation that takes g to c best, by the moments K = sum c gᵀ, and what it explains, tr(Rᵀ K). mirrored: the same with a
/// reflection.
struct BestTurn {
  Mat3 R = Mat3::Identity();
  Scalar along = 0, mirrored = 0;
};

BestTurn best_turn(const Mat3& K) {
  BestTurn best;
  Vec3 lambda;
  Mat3 V;
  symmetric_eigen(Mat3(K.transpose().lazyProduct(K)), &lambda, &V);
  const Scalar s_2 = std::sqrt(std::max(Scalar(0), lambda(2))), s_1 = std::sqrt(std::max(Scalar(0), lambda(1)));
  if (!(s_2 > Scalar(0))) return best;
  const Vec3 u_2 = K * V.col(2) / s_2;
  Vec3 u_1 = K * V.col(1);
  u_1 -= u_2 * u_2.dot(u_1);
  if (!(u_1.norm() > kTiny * s_2)) {
    const Vec3 other = std::abs(u_2.x()) < kNotAlong ? Vec3::UnitX() : Vec3::UnitY();
    u_1 = other - u_2 * u_2.dot(other);
  }
  u_1.normalize();
  const Vec3 u_0 = u_1.cross(u_2);
  best.R = u_0 * V.col(0).transpose() + u_1 * V.col(1).transpose() + u_2 * V.col(2).transpose();
  const Scalar s_0 = u_0.dot(K * V.col(0));
  best.along = s_2 + s_1 + s_0;
  best.mirrored = s_2 + s_1 - s_0;
  return best;
}

/// Share of the squares of c that c = s R g leaves, s free and above 0.
Scalar left_of(Scalar along, Scalar cc, Scalar gg) {
  return along > Scalar(0) && cc > Scalar(0) && gg > Scalar(0) ? Scalar(1) - along * along / (cc * gg) : Scalar(1);
}

}  // namespace

void RateAlignment::add(std::int64_t begin_ns, std::int64_t end_ns, const Vec3& rate_C) {
  if (count_ == kMax) std::copy(interval_ + 1, interval_ + count_--, interval_);
  interval_[count_++] = {begin_ns, end_ns, rate_C, Vec3::Zero(), Vec3::Zero(), false};
}

double RateAlignment::span() const {
  return count_ > 0 ? seconds(elapsed_ns(interval_[0].begin_ns, interval_[count_ - 1].end_ns)) : 0;
}

/// Sets the gyroscope's mean of each interval, from its samples by the trapezoid rule. False where most have none.
bool RateAlignment::gather(const ImuLog& log, double delay_s) {
  const std::int64_t shift_ns = nanoseconds(delay_s), longest_ns = 3 * log.counts().median_ns;
  int at = 1, found = 0;
  for (int i = 0; i < count_; ++i) {
    Interval& interval = interval_[i];
    const std::int64_t from_ns = interval.begin_ns - shift_ns, to_ns = interval.end_ns - shift_ns;
    while (at < log.held() && log[at].t_ns <= from_ns) ++at;
    interval.has_g = at < log.held() && log[at - 1].t_ns <= from_ns;
    Vec3 sum = Vec3::Zero();
    std::int64_t t_ns = from_ns;
    for (int k = at; interval.has_g && t_ns < to_ns; ++k) {
      if (k >= log.held() || elapsed_ns(log[k - 1].t_ns, log[k].t_ns) > longest_ns) {
        interval.has_g = false;
        break;
      }
      const ImuSample &a = log[k - 1], &b = log[k];
      const std::int64_t end_ns = std::min(to_ns, b.t_ns);
      const Scalar step = static_cast<Scalar>(seconds(end_ns - t_ns)),
                   whole = static_cast<Scalar>(seconds(b.t_ns - a.t_ns));
      const Scalar middle = static_cast<Scalar>(seconds(t_ns - a.t_ns) + seconds(end_ns - a.t_ns)) / 2 / whole;
      for (int j = 0; j < 3; ++j) sum(j) += step * (a.gyro[j] + middle * (b.gyro[j] - a.gyro[j]));
      t_ns = end_ns;
    }
    interval.g = sum / static_cast<Scalar>(seconds(elapsed_ns(from_ns, to_ns)));
    found += interval.has_g;
  }
  return found >= kMinIntervals && kMinWithGyro * found >= count_;
}

RateAlignment::Moments RateAlignment::moments() const {
  Moments m;
  for (int i = 0; i < count_; ++i) {
    if (!interval_[i].has_g) continue;
    ++m.n;
    m.c += interval_[i].c;
    m.g += interval_[i].g;
  }
  if (m.n == 0) return m;
  m.c /= static_cast<Scalar>(m.n);
  m.g /= static_cast<Scalar>(m.n);
  for (int i = 0; i < count_; ++i) {
    if (!interval_[i].has_g) continue;
    const Vec3 c = interval_[i].c - m.c, g = interval_[i].g - m.g;
    m.cc += c.squaredNorm();
    m.cg += c * g.transpose();
    m.gg += g * g.transpose();
  }
  return m;
}

Scalar RateAlignment::left_at(const ImuLog& log, double delay_s, const Mat3* R_CB) {
  if (!gather(log, delay_s)) return Scalar(-1);
  const Moments m = moments();
  const Scalar along = R_CB != nullptr ? (R_CB->transpose().lazyProduct(m.cg)).trace() : best_turn(m.cg).along;
  return left_of(along, m.cc, m.gg.trace());
}

/// The delay at which least is left: in steps, then in fine ones, then by a parabola.
bool RateAlignment::search(const ImuLog& log, double at_s, double reach_s, const Mat3* R_CB, RateFit* out,
                           double* delay_s) {
  constexpr int kMaxSteps = 2 * static_cast<int>(kReach / kCoarse) + 1;
  Scalar left[kMaxSteps];
  const int side = std::min(static_cast<int>(reach_s / kCoarse), (kMaxSteps - 1) / 2), steps = 2 * side + 1;
  int best = -1;
  for (int k = 0; k < steps; ++k) {
    left[k] = left_at(log, at_s + (k - side) * kCoarse, R_CB);
    if (left[k] >= Scalar(0) && (best < 0 || left[k] < left[best])) best = k;
  }
  if (best < 0) return false;
  out->at_end = best == 0 || best == steps - 1;
  out->next_left = 1;
  for (int k = 1; k + 1 < steps; ++k)
    if (std::abs(k - best) * kCoarse > kApart && left[k] >= Scalar(0) && left[k] <= left[k - 1] &&
        left[k] <= left[k + 1])
      out->next_left = std::min(out->next_left, left[k]);
  double at = at_s + (best - side) * kCoarse, step = kCoarse;
  while (step > kFine) {
    step /= 2;
    const Scalar here = left_at(log, at, R_CB), before = left_at(log, at - step, R_CB),
                 after = left_at(log, at + step, R_CB);
    if (before >= Scalar(0) && before < here) at -= step;
    if (after >= Scalar(0) && after < here && !(before >= Scalar(0) && before < after && before < here)) at += step;
  }
  const Scalar before = left_at(log, at - step, R_CB), after = left_at(log, at + step, R_CB),
               here = left_at(log, at, R_CB);
  if (here < Scalar(0)) return false;
  const Scalar bend = before - 2 * here + after;
  if (before >= Scalar(0) && after >= Scalar(0) && bend > Scalar(0))
    at += std::clamp(static_cast<double>((before - after) / (2 * bend)), -1.0, 1.0) * step;
  *delay_s = at;
  return true;
}

/// The fit at a delay, with the sigmas of what it leaves. Of residuals r and slopes s of c by the delay, less what the mean takes,
///
///   sigma² = max(sum |r|² / (3 n - 7) I, sum over clusters of a second (sum s r)²) / I²,   I = sum |s|²
///
/// The first is for residuals that know nothing of each other, the second for any that do not reach across clusters.
void RateAlignment::explain(const ImuLog& log, double delay_s, bool delay_known, const Mat3* R_CB, RateFit* out) {
  gather(log, delay_s + kFine);
  for (int i = 0; i < count_; ++i) interval_[i].slope = interval_[i].has_g ? interval_[i].g : Vec3(Vec3::Zero());
  gather(log, delay_s - kFine);
  for (int i = 0; i < count_; ++i)
    interval_[i].slope = (interval_[i].slope - interval_[i].g) / static_cast<Scalar>(2 * kFine);
  gather(log, delay_s);
  const Moments m = moments();
  const BestTurn turn = best_turn(m.cg);
  const Scalar gg = m.gg.trace();
  out->count = m.n;
  out->delay = static_cast<Scalar>(delay_s);
  out->R_CB = R_CB != nullptr ? *R_CB : turn.R;
  const Scalar along = R_CB != nullptr ? (R_CB->transpose().lazyProduct(m.cg)).trace() : turn.along;
  out->left = left_of(along, m.cc, gg);
  out->scale = gg > Scalar(0) ? along / gg : Scalar(0);
  out->turning = std::sqrt(m.cc / static_cast<Scalar>(std::max(1, m.n)));
  out->left_mirrored = left_of(turn.mirrored, m.cc, gg);
  out->mirrored = out->left_mirrored < kMirrored * left_of(turn.along, m.cc, gg);
  const Mat3 sR = out->scale * out->R_CB;
  Scalar squares = 0, information = 0, clustered = 0, cluster = 0;
  std::int64_t until_ns = INT64_MIN;
  for (int i = 0; i < count_; ++i) {
    if (!interval_[i].has_g) continue;
    const Vec3 r = interval_[i].c - m.c - sR * (interval_[i].g - m.g), s = sR * interval_[i].slope;
    if (interval_[i].begin_ns >= until_ns) {
      until_ns = interval_[i].begin_ns + nanoseconds(1);
      clustered += cluster * cluster;
      cluster = 0;
    }
    cluster += s.dot(r);
    information += s.squaredNorm();
    squares += r.squaredNorm();
  }
  clustered += cluster * cluster;
  const Scalar variance = squares / static_cast<Scalar>(std::max(1, 3 * m.n - 7));
  out->sigma_delay = delay_known               ? Scalar(0)
                     : information > Scalar(0) ? std::sqrt(std::max(variance * information, clustered)) / information
                                               : Scalar(1);
  Vec3 lambda;
  Mat3 V;
  symmetric_eigen(m.gg, &lambda, &V);  // about the axis of the largest, the rotation follows from the other two
  const Scalar of_turn = out->scale * out->scale * (lambda(0) + lambda(1));
  const Scalar widen = information > Scalar(0) ? std::max(Scalar(1), clustered / (variance * information)) : Scalar(1);
  out->sigma_turn = of_turn > Scalar(0) ? std::min(Scalar(3), std::sqrt(widen * variance / of_turn)) : Scalar(3);
}

bool RateAlignment::fit(const ImuLog& log, double at_s, double reach_s, const Mat3* R_CB, RateFit* out) {
  *out = RateFit();
  if (count_ < kMinIntervals || log.held() < 2) return false;
  double delay_s = at_s;
  if (reach_s > 0) {
    if (!search(log, at_s, reach_s, R_CB, out, &delay_s)) return false;
  } else if (left_at(log, at_s, R_CB) < Scalar(0)) {
    return false;
  }
  explain(log, delay_s, !(reach_s > 0), R_CB, out);
  return out->count >= kMinIntervals;
}

}  // namespace pf
