#ifndef PLANEFOLD_CAPTURE_TURN_FIT_H
#define PLANEFOLD_CAPTURE_TURN_FIT_H

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

namespace pf::capture {

using Quaternion = std::array<double, 4>;  // w x y z

/// q Exp(w t)
Quaternion turn(const Quaternion& q, const std::array<double, 3>& w, double t);
/// The rate between two samples.
std::array<double, 3> mean_of(const std::array<double, 3>& a, const std::array<double, 3>& b);
/// Of the turn from a to b [rad].
double angle_between(const Quaternion& a, const Quaternion& b);

inline double seconds(int64_t ns) { return 1e-9 * static_cast<double>(ns); }

struct TurnSample {
  int64_t t_ns;
  std::array<double, 3> gyro;
  Quaternion q;  ///< since the first sample
};

struct TurnInterval {
  int64_t begin_ns, end_ns;
  double rate;  ///< of the camera [rad/s]
};

/// c = a + b g(d) by least squares, c the camera's rates and g(d) the unit's whose times are d later: at one d after the
/// other.
class TurnFit {
 public:
  TurnFit(const std::deque<TurnSample>& samples, const std::deque<TurnInterval>& intervals);

  /// What is below is of this offset, and of the intervals that have samples there.
  void at(double offset_s);
  int64_t count() const { return static_cast<int64_t>(g_.size()); }
  double correlation() const { return correlation_; }
  /// Standard deviation of c [rad/s].
  double turning() const;
  /// Share of the squares of c that is left unexplained.
  double left() const { return correlation_ > 0.0 ? 1.0 - correlation_ * correlation_ : 1.0; }
  /// Of d [s].
  double sigma() const;

  /// From here on without the intervals far from the fit: a pose that jumped, a sample that was wrong.
  void leave_out_the_far();

 private:
  bool turned_at(int64_t t_ns, Quaternion& q) const;
  bool rate_over(const TurnInterval& interval, double offset_s, double& rate) const;
  std::vector<double> slopes() const;

  const std::deque<TurnSample>& samples_;
  const std::deque<TurnInterval>& intervals_;
  std::vector<bool> used_;
  int64_t longest_step_ns_ = 0;

  double offset_s_ = 0.0, mean_g_ = 0.0, cc_ = 0.0, gg_ = 0.0, b_ = 0.0, correlation_ = 0.0;
  std::vector<std::size_t> indices_;  ///< of the intervals that g_ and c_ are of
  std::vector<double> g_, c_, residuals_;
};

}  // namespace pf::capture

#endif
