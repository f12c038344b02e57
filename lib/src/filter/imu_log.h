#pragma once

#include <cstdint>

#include "base/arena.h"
#include "base/scalar.h"

/// Samples of an inertial measurement unit in their order: the newest in a ring, all of them counted. imu_path.h integrates them.

namespace pf {

class Archive;

struct ImuSample {
  std::int64_t t_ns;
  Scalar gyro[3];   ///< angular velocity in the axes of the unit [rad/s]
  Scalar accel[3];  ///< specific force in the axes of the unit [m/s^2]
};

struct ImuRanges {
  Scalar gyro = 0;   ///< [rad/s] 0: not known
  Scalar accel = 0;  ///< [m/s^2] the same
};

/// Counts since the beginning, unless stated otherwise.
struct ImuCounts {
  std::int64_t samples = 0, since_frame = 0;
  std::int64_t last_interval = 0;  ///< samples between the last two frames
  std::int64_t late = 0;           ///< samples that are not after the last frame
  std::int64_t gaps = 0, missing = 0, saturated = 0;
  std::int64_t first_ns = 0, last_ns = 0, median_ns = 0, longest_ns = 0;
};

class ImuLog {
 public:
  void layout(Arena& arena, int capacity);
  void init(int capacity, const ImuRanges& ranges);

  /// Adds a sample, later than all before; the caller has checked it.
  void add(const ImuSample& sample);
  /// Notes a frame at this time, before which samples up to it have come.
  void mark_frame(std::int64_t t_ns);

  bool any() const { return counts_.samples > 0; }
  const ImuCounts& counts() const { return counts_; }
  /// Mean rate between the first sample and the last [Hz]; 0 of fewer than two.
  double rate_hz() const;

  int held() const { return held_; }
  /// 0: the oldest sample that is held.
  const ImuSample& operator[](int i) const { return ring_[(begin_ + i) % capacity_]; }

  void carry(Archive& archive);  ///< base/archive.h

 private:
  void time_interval(std::int64_t interval_ns);

  ImuSample* ring_ = nullptr;  ///< capacity_; null where that is 0
  int capacity_ = 0;
  int begin_ = 0, held_ = 0;
  ImuRanges ranges_;
  ImuCounts counts_;
  bool has_frame_ = false;
  std::int64_t frame_ns_ = 0;
};

}  // namespace pf
