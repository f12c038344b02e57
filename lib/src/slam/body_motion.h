#pragma once

#include <cstdint>

#include "filter/filter.h"
#include "slam/settings.h"

/// Moves the body to the time of a frame, and predicts it for later times.

namespace pf {

class BodyMotion {
 public:
  BodyMotion(const Settings& settings, Filter& filter) : settings_(settings), filter_(filter) {}

  static constexpr std::int64_t kMaxGapNs = 2000000000;  ///< [ns] between frames, that a prediction goes over

  void init() { data_ = Data(); }
  /// Known change of the velocities in camera axes, until the next frame.
  void push_control(const Vec3& dv_C, const Vec3& dw_C) {
    data_.dv_C += dv_C;
    data_.dw_C += dw_C;
  }

  /// The filter's body moves on by this time. coasting_or_lost: by prediction alone; nothing_measured: nothing was measured in the last frame.
  void advance(std::int64_t gap_ns, bool coasting_or_lost, bool nothing_measured);
  /// Moves a body by the configured model, with its Jacobian and noise.
  void predict(Body& body, Scalar dt, const MotionNoise& noise, Transition* transition) const;
  /// Body and pose covariance (6x6) at t_ns, predicted where that is after now_ns.
  void predict_pose(std::int64_t now_ns, std::int64_t t_ns, Body* body, Mat6* covariance) const;

 private:
  /// What is kept between frames.
  struct Data {
    Vec3 dv_C = Vec3::Zero();
    Vec3 dw_C = Vec3::Zero();
  };

  void damp(Scalar dt);

  const Settings& settings_;
  Filter& filter_;
  Data data_;
};

}  // namespace pf
