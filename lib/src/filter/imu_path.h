#pragma once

#include "filter/imu_log.h"
#include "filter/motion.h"
#include "filter/preintegral.h"

namespace pf {

/// An inertial unit as the config describes it.
struct ImuUnit {
  ImuNoise noise;
  Mounting mounting;
  std::int64_t delay_ns = 0;  ///< t_frame = t_sample + delay
  Scalar gravity = 0;         ///< [m/s^2]
  /// Of the mounting and the delay [rad], [m], [s]; 0: constant.
  Scalar sigma_turn = 0, sigma_place = 0, sigma_delay = 0;
  Scalar sigma_scale = 0;  ///< of the entries of its intrinsics; 0: the same
};

/// Without samples: the rate and the specific force that the body would have with constant velocity, and its accelerations.
struct Coasting {
  Vec3 w_B = Vec3::Zero();  ///< [rad/s]
  Vec3 f_B = Vec3::Zero();  ///< [m/s^2] in the unit's axes at the beginning, without bias
  MotionNoise noise = {};
};

/// Integrates the samples between two times on their own clock, each end interpolated. Where samples are missing for more than kMaxGap of
/// their median interval, it interpolates, with noise for the unknown readings; behind the last sample it extrapolates the last two for at
/// most kMaxHold intervals, then coasts. *at_end gets the reading at the end. Returns how much of the time was coasted [s].
Scalar integrate_samples(const ImuLog& log, std::int64_t from_ns, std::int64_t to_ns, const Coasting& coasting,
                         Preintegral* sum, ImuReading* at_end);

/// Reading at a time on the unit's own clock: on the line through two samples without a gap, at most kMaxHold intervals behind them. False
/// where there are none.
bool reading_at(const ImuLog& log, std::int64_t t_ns, ImuReading* reading);

}  // namespace pf
