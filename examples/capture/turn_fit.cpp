#include "turn_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pf::capture {

namespace {

constexpr int64_t kCluster_ns = 1'000'000'000;  ///< residuals further apart say nothing about each other
constexpr double kSlopeStep_s = 0.001;

Quaternion product(const Quaternion& a, const Quaternion& b) {
  return {a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3], a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
          a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1], a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]};
}

int64_t nanoseconds(double s) { return static_cast<int64_t>(std::llround(1e9 * s)); }

}  // namespace

std::array<double, 3> mean_of(const std::array<double, 3>& a, const std::array<double, 3>& b) {
  return {0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]), 0.5 * (a[2] + b[2])};
}

Quaternion turn(const Quaternion& q, const std::array<double, 3>& w, double t) {
  const double rate = std::sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
  const double half = 0.5 * rate * t, s = rate > 0.0 ? std::sin(half) / rate : 0.0;
  Quaternion r = product(q, {std::cos(half), s * w[0], s * w[1], s * w[2]});
  const double norm = std::sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2] + r[3] * r[3]);
  for (double& part : r) {
    part /= norm;
  }
  return r;
}

double angle_between(const Quaternion& a, const Quaternion& b) {
  const Quaternion r = product({a[0], -a[1], -a[2], -a[3]}, b);
  return 2.0 * std::atan2(std::sqrt(r[1] * r[1] + r[2] * r[2] + r[3] * r[3]), std::fabs(r[0]));
}

TurnFit::TurnFit(const std::deque<TurnSample>& samples, const std::deque<TurnInterval>& intervals)
    : samples_(samples), intervals_(intervals), used_(intervals.size(), true) {
  std::vector<int64_t> steps;
  for (size_t i = 1; i < samples_.size(); ++i) {
    steps.push_back(samples_[i].t_ns - samples_[i - 1].t_ns);
  }
  if (!steps.empty()) {
    std::nth_element(steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2), steps.end());
    longest_step_ns_ = 3 * steps[steps.size() / 2];
  }
}

void TurnFit::at(double offset_s) {
  offset_s_ = offset_s;
  indices_.clear(), g_.clear(), c_.clear(), residuals_.clear();
  for (size_t i = 0; i < intervals_.size(); ++i) {
    double g = 0.0;
    if (used_[i] && rate_over(intervals_[i], offset_s, g)) {
      indices_.push_back(i);
      g_.push_back(g);
      c_.push_back(intervals_[i].rate);
    }
  }
  const double n = static_cast<double>(count());
  mean_g_ = cc_ = gg_ = 0.0;
  double mean_c = 0.0, gc = 0.0;
  for (size_t i = 0; i < g_.size(); ++i) {
    mean_c += c_[i] / n;
    mean_g_ += g_[i] / n;
  }
  for (size_t i = 0; i < g_.size(); ++i) {
    cc_ += (c_[i] - mean_c) * (c_[i] - mean_c);
    gg_ += (g_[i] - mean_g_) * (g_[i] - mean_g_);
    gc += (g_[i] - mean_g_) * (c_[i] - mean_c);
  }
  correlation_ = cc_ > 0.0 && gg_ > 0.0 ? gc / std::sqrt(cc_ * gg_) : 0.0;
  b_ = gg_ > 0.0 ? gc / gg_ : 0.0;
  for (size_t i = 0; i < g_.size(); ++i) {
    residuals_.push_back(c_[i] - mean_c - b_ * (g_[i] - mean_g_));
  }
}

double TurnFit::turning() const { return count() > 0 ? std::sqrt(cc_ / static_cast<double>(count())) : 0.0; }

/// dg/dd of the intervals of the last fit.
std::vector<double> TurnFit::slopes() const {
  std::vector<double> slopes;
  for (size_t i : indices_) {
    double before = 0.0, after = 0.0;
    const bool both = rate_over(intervals_[i], offset_s_ - kSlopeStep_s, before) &&
                      rate_over(intervals_[i], offset_s_ + kSlopeStep_s, after);
    slopes.push_back(both ? (after - before) / (2.0 * kSlopeStep_s) : 0.0);
  }
  return slopes;
}

/// Of the linear fit about the last offset, in which a, b and d are unknown; s_i is what a and b leave of the slopes of d:
///
///   sigma^2 = max(sum_i r_i^2 / (n - 3) * I, sum over clusters (sum_i s_i r_i)^2) / I^2,   I = sum_i s_i^2
///
/// The first is for residuals that know nothing of each other, the second for any that do not reach across clusters.
double TurnFit::sigma() const {
  const std::vector<double> of_d = slopes();
  const double n = static_cast<double>(count());
  double mean = 0.0, along = 0.0;
  for (size_t i = 0; i < of_d.size(); ++i) {
    mean += of_d[i] / n;
    along += (g_[i] - mean_g_) * of_d[i] / gg_;
  }
  double information = 0.0, squares = 0.0, clustered = 0.0, cluster = 0.0;
  int64_t until_ns = std::numeric_limits<int64_t>::min();
  for (size_t i = 0; i < of_d.size(); ++i) {
    const double slope = b_ * (of_d[i] - mean - along * (g_[i] - mean_g_));
    const int64_t t_ns = intervals_[indices_[i]].begin_ns;
    if (t_ns >= until_ns) {
      until_ns = t_ns + kCluster_ns;
      clustered += cluster * cluster;
      cluster = 0.0;
    }
    cluster += slope * residuals_[i];
    information += slope * slope;
    squares += residuals_[i] * residuals_[i];
  }
  clustered += cluster * cluster;
  const double white = squares / std::max(1.0, n - 3.0) * information;
  return information > 0.0 ? std::sqrt(std::max(white, clustered)) / information : 1e9;
}

void TurnFit::leave_out_the_far() {
  std::vector<double> sizes;
  for (double residual : residuals_) {
    sizes.push_back(std::fabs(residual));
  }
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  for (size_t i = 0; i < residuals_.size(); ++i) {
    used_[indices_[i]] = std::fabs(residuals_[i]) <= 6.0 * *middle + 1e-9;
  }
}

bool TurnFit::turned_at(int64_t t_ns, Quaternion& q) const {
  const auto after = std::lower_bound(samples_.begin(), samples_.end(), t_ns,
                                      [](const TurnSample& s, int64_t t) { return s.t_ns < t; });
  if (after == samples_.begin() || after == samples_.end()) {
    return false;
  }
  const TurnSample &a = *(after - 1), &b = *after;
  const int64_t step_ns = b.t_ns - a.t_ns;
  if (step_ns > longest_step_ns_) {
    return false;
  }
  q = turn(a.q, mean_of(a.gyro, b.gyro), seconds(t_ns - a.t_ns));
  return true;
}

bool TurnFit::rate_over(const TurnInterval& interval, double offset_s, double& rate) const {
  const int64_t offset_ns = nanoseconds(offset_s);
  Quaternion begin{}, end{};
  if (!turned_at(interval.begin_ns - offset_ns, begin) || !turned_at(interval.end_ns - offset_ns, end)) {
    return false;
  }
  rate = angle_between(begin, end) / seconds(interval.end_ns - interval.begin_ns);
  return true;
}

}  // namespace pf::capture
