#pragma once

#include <cstdint>

#include "filter/imu_log.h"
#include "geometry/so3.h"

/// Estimates a gyroscope's delay, axes and scale from the camera's own rotations, which come from images alone
/// (lib/docs/theory/inertial.md, "Rates").

namespace pf {

class Archive;

/// c = scale R_CB g(t - delay) + b over the intervals between frames, c the camera's rates and g the gyroscope's means.
struct RateFit {
  int count = 0;           ///< intervals
  Scalar delay = 0;        ///< [s] t_frame = t_sample + delay
  Scalar sigma_delay = 0;  ///< from the residuals of the rates
  Mat3 R_CB = Mat3::Identity();
  Scalar sigma_turn = 0;     ///< [rad] about the worst axis
  Scalar scale = 0;          ///< of the camera's rates to the gyroscope's
  Scalar left = 1;           ///< share of the squares of c that is not explained
  Scalar next_left = 1;      ///< the same at the next best delay
  Scalar turning = 0;        ///< standard deviation of c, over the axes [rad/s]
  Scalar left_mirrored = 1;  ///< share that left-handed axes leave
  bool mirrored = false;     ///< a reflection fits far better than any rotation
  bool at_end = false;       ///< the best delay is the last that was tried
};

class RateAlignment {
 public:
  static constexpr double kReach = 0.2;  ///< [s] largest error of the delay that is searched

  void init() { count_ = 0; }
  /// Adds the camera's rate between two frames, in its axes.
  void add(std::int64_t begin_ns, std::int64_t end_ns, const Vec3& rate_C);
  int count() const { return count_; }
  /// Time from the first interval to the last [s].
  double span() const;

  /// Fits rates. R_CB: known axes; null: they are estimated too. at_s: delay about which is searched, by reach_s to either side (0: it is
  /// known). False where samples are missing or nothing rotates.
  bool fit(const ImuLog& log, double at_s, double reach_s, const Mat3* R_CB, RateFit* out);

  void carry(Archive& archive);  ///< base/archive.h

 private:
  static constexpr int kMax = 128;

  struct Interval {
    std::int64_t begin_ns, end_ns;
    Vec3 c, g, slope;
    bool has_g;
  };
  struct Moments {
    int n = 0;
    Vec3 c = Vec3::Zero(), g = Vec3::Zero();  ///< means
    Scalar cc = 0;
    Mat3 cg = Mat3::Zero(), gg = Mat3::Zero();
  };

  bool gather(const ImuLog& log, double delay_s);
  Moments moments() const;
  Scalar left_at(const ImuLog& log, double delay_s, const Mat3* R_CB);
  bool search(const ImuLog& log, double at_s, double reach_s, const Mat3* R_CB, RateFit* out, double* delay_s);
  void explain(const ImuLog& log, double delay_s, bool delay_known, const Mat3* R_CB, RateFit* out);

  Interval interval_[kMax];
  int count_ = 0;
};

}  // namespace pf
