#ifndef PLANEFOLD_CAPTURE_TIME_OFFSET_H
#define PLANEFOLD_CAPTURE_TIME_OFFSET_H

#include <planefold/planefold.h>

#include <cstdint>
#include <deque>
#include <string>

#include "turn_fit.h"

namespace pf::capture {

/// By how much a unit's times differ from the camera's, and how sure that is.
struct TimeOffset {
  bool known = false;
  std::string why_not;       ///< one line
  double offset_s = 0.0;     ///< to add to the unit's times
  double sigma_s = 0.0;      ///< from what the rates leave unexplained
  double correlation = 0.0;  ///< of the two rates, at this offset; -1 .. 1
  int64_t intervals = 0;     ///< between frames that were compared
  double turning = 0.0;      ///< standard deviation of the camera's rate [rad/s]
};

/// Compares how fast the camera turns from frame to frame with how fast the gyroscope says that it does:
///
///   c_i = |Log(R_WC(t_i)ᵀ R_WC(t_i+1))| / dt_i       from the poses of two tracked frames
///   g_i(d), likewise from the rates, over [t_i - d, t_i+1 - d]
///
/// The angle of a turn is the same for the camera and the unit however they are mounted, and a scale and a constant
/// (noise, bias) do not matter either: d is where the correlation of c and g(d) is largest, within kReach_s to either
/// side; between steps by a parabola. Its standard deviation is that of the least squares fit c = a + b g(d), with
/// residuals that may depend on each other within a second.
class TimeOffsetEstimator {
 public:
  static constexpr double kReach_s = 0.5;

  void add(const pf_imu_sample_t& sample);
  void add_frame(const pf_pose_t& pose, bool tracked);
  /// Of the newest minute.
  TimeOffset estimate() const;

 private:
  std::deque<TurnSample> samples_;
  std::deque<TurnInterval> intervals_;
  int64_t last_t_ns_ = 0;
  Quaternion last_q_{};
  bool has_frame_ = false;
};

}  // namespace pf::capture

#endif
