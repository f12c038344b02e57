#pragma once

#include <cstdint>

#include "filter/filter.h"
#include "frame/settings.h"
#include "inertial/unit_noise.h"

/// Predicts the body: to the time of each frame in the filter, and to later times for display.

namespace pf {

class Archive;

class BodyMotion {
 public:
  BodyMotion(const Settings& settings, Filter& filter, const ImuLog& imu)
      : settings_(settings), filter_(filter), imu_(imu), noise_(settings, imu) {}

  static constexpr std::int64_t kMaxGapNs = 2000000000;  ///< [ns] longest time between frames that a prediction covers

  void init() { data_ = Data(); }
  /// Noise of the inertial unit; init() keeps it.
  UnitNoise& unit_noise() { return noise_; }
  const UnitNoise& unit_noise() const { return noise_; }
  /// Known change of the velocities in camera axes, until the next frame.
  void push_control(const Vec3& dv_C, const Vec3& dw_C) {
    data_.given = true;
    data_.dv_C += dv_C;
    data_.dw_C += dw_C;
  }

  /// Predicts the filter's body from one frame's time to the next. coasting_or_lost: the tracking state; nothing_measured: the last frame
  /// had no inlier.
  void advance(std::int64_t before_ns, std::int64_t t_ns, bool coasting_or_lost, bool nothing_measured);
  /// Sets the angular velocity at a frame's time from samples, of a body that begins with this frame and is not predicted to it.
  void begin(std::int64_t t_ns, Body* body) const;
  /// The time of a frame on the clock of the samples.
  std::int64_t on_unit_clock(std::int64_t t_ns) const;
  /// Prediction by the configured motion model between two frames' times.
  void predict(const Body& body, std::int64_t before_ns, std::int64_t t_ns, const MotionNoise& noise,
               Transition* transition) const;
  /// The same as if no samples had come: white accelerations about the rate and the velocity.
  void predict_coasting(const Body& body, std::int64_t before_ns, std::int64_t t_ns, Transition* transition) const;
  /// Body and pose covariance (6x6) at t_ns; predicted if t_ns is after now_ns.
  void predict_pose(std::int64_t now_ns, std::int64_t t_ns, Body* body, Mat6* covariance) const;

  void carry(Archive& archive);  ///< base/archive.h

 private:
  /// What is kept between frames.
  struct Data {
    bool given = false;
    Vec3 dv_C = Vec3::Zero();
    Vec3 dw_C = Vec3::Zero();
  };

  void predict_by_samples(const Body& body, std::int64_t before_ns, std::int64_t t_ns, const MotionNoise& noise,
                          Transition* transition) const;
  Bend bend_of_readout(std::int64_t unit_ns, const ImuReading& now, const Body& body) const;
  Coasting coasting(const Body& body, const MotionNoise& noise) const;
  void predict_by(const Body& body, const Preintegral& samples, const MotionNoise& noise, Transition* transition) const;
  void predict_after(const Body& body, Scalar dt, const MotionNoise& noise, Transition* transition) const;
  Mat6 covariance_by_intrinsics(const Transition& transition) const;
  MotionNoise limited_noise() const;
  bool has_rate() const;
  void damp(Scalar dt);

  const Settings& settings_;
  Filter& filter_;
  const ImuLog& imu_;
  UnitNoise noise_;
  Data data_;
};

}  // namespace pf
