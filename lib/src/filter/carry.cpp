#include "model/carry.h"

#include "base/archive.h"
#include "filter/filter.h"
#include "filter/imu_log.h"

namespace pf {
namespace {

/// Whether the segments of blocks are the rows from `first` to n, each once, those that are held before all others. mark: n numbers.
bool are_segments(const Segment* at, const State& state, int first, int held_end, int n, int* mark) {
  for (int row = first; row < n; ++row) mark[row] = 0;
  int rows = 0;
  for (int b = 0; b < state.slots; ++b) {
    if (at[b].size != state.block[b].size) return false;
    if (at[b].size == 0) continue;
    const int end = at[b].first + at[b].size;
    if (at[b].first < first || end > n || (at[b].first < held_end && end > held_end)) return false;
    for (int row = at[b].first; row < end; ++row)
      if (mark[row]++ != 0) return false;
    rows += at[b].size;
  }
  return rows == n - first;
}

}  // namespace

/// What an update leaves in scratch ends with it.
void BlockFilter::carry(Archive& archive, const State& state) {
  const int body_rows = leading_dim_ + considered_;
  archive.within(considered_, 0, body_rows);
  archive.within(P_.n, body_rows, max_dim_);
  archive.within(held_dim_, considered_, P_.n - body_rows + considered_);
  archive.numbers(owed_);
  if (archive.is_reading()) leading_dim_ = body_rows - considered_;
  for (int b = 0; b < blocks_; ++b) {
    archive.within(at_[b].first, -1, max_dim_);
    archive.within(at_[b].size, 0, Block::kMaxRows);
  }
  for (int i = 0; i < P_.n; ++i)
    for (int j = 0; j <= i; ++j) archive.numbers(P_.row(i)[j]);
  if (!archive.is_reading()) return;
  gained_ = 0;
  archive.require(are_segments(at_, state, body_rows, held_end(), P_.n, order_));
}

void GaugePrior::carry(Archive& archive) {
  archive.numbers(V_);
  archive.flags(any_);
}

void Filter::carry(Archive& archive) {
  state_.carry(archive);
  blocks_.carry(archive, state_);
  apart_.carry(archive);
  archive.flags(keep_gauge_);
  archive.within(told_updates_, -1, Archive::kMaxCount);
  archive.any(generation_, cameras_);
  archive.numbers(roughness_);
  if (!archive.is_reading()) return;
  transport_.init();
  archive.require(body_is_sound());
  for (int s = 0; s < state_.slots && !archive.failed(); ++s)
    archive.require(state_.block[s].kind == BlockKind::kNone || block_is_sound(s));
}

void ImuLog::carry(Archive& archive) {
  auto& [samples, since_frame, last_interval, late, gaps, missing, saturated, first_ns, last_ns, median_ns,
         longest_ns] = counts_;
  archive.within(begin_, 0, capacity_ > 0 ? capacity_ - 1 : 0);
  archive.within(held_, 0, capacity_);
  for (std::int64_t* count : {&samples, &since_frame, &last_interval, &late, &gaps, &missing, &saturated})
    archive.within(*count, 0, INT64_MAX / 2);
  archive.any(first_ns, last_ns, median_ns, longest_ns, frame_ns_);
  archive.flags(has_frame_);
  for (int i = 0; i < held_; ++i) {
    ImuSample& sample = ring_[(begin_ + i) % capacity_];
    archive.any(sample.t_ns);
    archive.numbers(sample.gyro, sample.accel);
    archive.require(i == 0 || sample.t_ns > (*this)[i - 1].t_ns);
  }
}

}  // namespace pf
