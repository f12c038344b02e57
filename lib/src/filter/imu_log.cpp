#include "filter/imu_log.h"

#include <cmath>

#include "base/elapsed.h"
#include "filter/tuning.h"

namespace pf {
namespace {

using namespace tuning::imu;

bool reaches(const Scalar* values, Scalar range) {
  if (!(range > Scalar(0))) return false;
  for (int i = 0; i < 3; ++i)
    if (std::fabs(values[i]) >= kSaturation * range) return true;
  return false;
}

}  // namespace

void ImuLog::layout(Arena& arena, int capacity) { ring_ = arena.take<ImuSample>(static_cast<std::size_t>(capacity)); }

void ImuLog::init(int capacity, const ImuRanges& ranges) {
  capacity_ = capacity;
  begin_ = held_ = 0;
  ranges_ = ranges;
  counts_ = ImuCounts();
  has_frame_ = false;
  frame_ns_ = 0;
}

void ImuLog::add(const ImuSample& sample) {
  if (any()) {
    time_interval(elapsed_ns(counts_.last_ns, sample.t_ns));
  } else {
    counts_.first_ns = sample.t_ns;
  }
  counts_.last_ns = sample.t_ns;
  ++counts_.samples;
  ++counts_.since_frame;
  if (has_frame_ && sample.t_ns <= frame_ns_) ++counts_.late;
  if (reaches(sample.gyro, ranges_.gyro) || reaches(sample.accel, ranges_.accel)) ++counts_.saturated;
  if (capacity_ == 0) return;
  ring_[(begin_ + held_) % capacity_] = sample;
  if (held_ < capacity_) {
    ++held_;
  } else {
    begin_ = (begin_ + 1) % capacity_;
  }
}

/// The median interval is a running median: it goes up or down by a small part of itself, so that a gap of any length
/// moves it no further than a late sample does.
void ImuLog::time_interval(std::int64_t interval_ns) {
  if (interval_ns > counts_.longest_ns) counts_.longest_ns = interval_ns;
  std::int64_t& median = counts_.median_ns;
  if (median == 0) {
    median = interval_ns;
    return;
  }
  const std::int64_t late_by = interval_ns - median;
  if (late_by > median / 2) {
    ++counts_.gaps;
    const std::int64_t missing = late_by / median + (late_by % median > median / 2 ? 1 : 0);
    if (counts_.missing < INT64_MAX / 4) counts_.missing += missing < INT64_MAX / 4 ? missing : INT64_MAX / 4;
  }
  const std::int64_t max_step = median / kAdaptSteps > 0 ? median / kAdaptSteps : 1;
  median += late_by > max_step ? max_step : late_by < -max_step ? -max_step : late_by;
}

void ImuLog::mark_frame(std::int64_t t_ns) {
  has_frame_ = true;
  frame_ns_ = t_ns;
  counts_.last_interval = counts_.since_frame;
  counts_.since_frame = 0;
}

double ImuLog::rate_hz() const {
  if (counts_.samples < 2) return 0.0;
  return static_cast<double>(counts_.samples - 1) / seconds(elapsed_ns(counts_.first_ns, counts_.last_ns));
}

}  // namespace pf
