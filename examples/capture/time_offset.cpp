#include "time_offset.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace pf::capture {

namespace {

constexpr int64_t kKept_ns = 60'000'000'000;
constexpr double kCoarse_s = 0.005, kFine_s = 0.001;
constexpr double kApart_s = 0.02;       ///< what lies nearer to the best offset is part of the same peak
constexpr int64_t kFewest = 40;         ///< intervals
constexpr double kLeastTurning = 0.03;  ///< rad/s, of the standard deviation
constexpr double kLeastCorrelation = 0.6;
constexpr double kMostSigma_s = 0.01;
constexpr double kClearlyWorse = 1.3;  ///< squares left at the next best offset, times those at the best

}  // namespace

void TimeOffsetEstimator::add(const pf_imu_sample_t& sample) {
  TurnSample next{sample.t_ns, {sample.gyro[0], sample.gyro[1], sample.gyro[2]}, {1, 0, 0, 0}};
  if (!samples_.empty()) {
    const TurnSample& last = samples_.back();
    next.q = turn(last.q, mean_of(last.gyro, next.gyro), seconds(next.t_ns - last.t_ns));
  }
  samples_.push_back(next);
  while (samples_.front().t_ns < sample.t_ns - kKept_ns) {
    samples_.pop_front();
  }
}

void TimeOffsetEstimator::add_frame(const pf_pose_t& pose, bool tracked) {
  const Quaternion q = {pose.q_WC[0], pose.q_WC[1], pose.q_WC[2], pose.q_WC[3]};
  if (tracked && has_frame_ && pose.t_ns > last_t_ns_) {
    intervals_.push_back({last_t_ns_, pose.t_ns, angle_between(last_q_, q) / seconds(pose.t_ns - last_t_ns_)});
    while (!intervals_.empty() && intervals_.front().begin_ns < pose.t_ns - kKept_ns) {
      intervals_.pop_front();
    }
  }
  last_t_ns_ = pose.t_ns;
  last_q_ = q;
  has_frame_ = tracked;
}

TimeOffset TimeOffsetEstimator::estimate() const {
  TimeOffset result;
  TurnFit fit(samples_, intervals_);
  const auto refuse = [&](const char* why) {
    result.why_not = why;
    return result;
  };
  fit.at(0.0);
  const int64_t enough = std::max(kFewest, static_cast<int64_t>(intervals_.size()) / 2);
  struct Step {
    double offset_s, left;
  };
  std::vector<Step> steps;
  const auto search = [&](double from_s, double to_s, double step_s) {
    steps.clear();
    for (int64_t k = 0; from_s + static_cast<double>(k) * step_s <= to_s + 1e-9; ++k) {
      fit.at(from_s + static_cast<double>(k) * step_s);
      if (fit.count() >= enough) {
        steps.push_back({from_s + static_cast<double>(k) * step_s, fit.left()});
      }
    }
    const auto best = std::min_element(steps.begin(), steps.end(), [](Step a, Step b) { return a.left < b.left; });
    return static_cast<size_t>(best - steps.begin());
  };
  size_t best = search(-kReach_s, kReach_s, kCoarse_s);
  if (steps.empty()) {
    return refuse("too few tracked frames with samples around them");
  }
  result.offset_s = steps[best].offset_s;
  fit.at(result.offset_s);
  fit.leave_out_the_far();
  best = search(-kReach_s, kReach_s, kCoarse_s);
  if (steps.empty()) {
    return refuse("too few tracked frames with samples around them");
  }
  const bool at_the_end = best == 0 || best + 1 == steps.size();
  double next_best = 1.0;
  for (size_t k = 1; k + 1 < steps.size(); ++k) {
    if (std::fabs(steps[k].offset_s - steps[best].offset_s) > kApart_s && steps[k].left <= steps[k - 1].left &&
        steps[k].left <= steps[k + 1].left) {
      next_best = std::min(next_best, steps[k].left);
    }
  }
  const double coarse_s = steps[best].offset_s, coarse_left = steps[best].left;
  best = search(coarse_s - kCoarse_s, coarse_s + kCoarse_s, kFine_s);
  result.offset_s = steps[best].offset_s;
  if (best > 0 && best + 1 < steps.size()) {
    const double before = steps[best - 1].left, here = steps[best].left, after = steps[best + 1].left;
    const double bend = before - 2.0 * here + after;
    result.offset_s += bend > 0.0 ? 0.5 * kFine_s * (before - after) / bend : 0.0;
  }
  fit.at(result.offset_s);
  result.intervals = fit.count();
  result.correlation = fit.correlation();
  result.turning = fit.turning();
  result.sigma_s = fit.sigma();
  if (result.turning < kLeastTurning) {
    return refuse("the camera turned too little, or too evenly");
  }
  if (at_the_end || result.correlation < kLeastCorrelation) {
    return refuse("the camera and the gyroscope do not turn alike at any offset within half a second");
  }
  if (next_best < kClearlyWorse * coarse_left) {
    return refuse("the motion repeats, and another offset fits nearly as well");
  }
  if (!(result.sigma_s < kMostSigma_s)) {
    return refuse("the camera turned too little, or too evenly");
  }
  result.known = true;
  return result;
}

}  // namespace pf::capture
